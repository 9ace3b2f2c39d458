"""How stiff is a polycrystal? Copper grains, each turned its own way, computed on the mesh of an image of them.

A crystal of copper is three times as stiff one way as another. The image repeats itself, so the mesh is asked for with
``periodic="xy"``: opposite sides get vertices at the same heights, and `periodic_pairs` says which belong together. Three ways to load the
sample then give three stiffnesses: displacements prescribed on the boundary (an upper bound), tractions prescribed (a lower one), and
periodicity between the two. All lie between what Reuss and Voigt knew without any geometry.

Linear triangles, in plane strain, need nothing but the arrays of the mesh: vertices, triangles, regions.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import splu
from scipy.spatial import KDTree

import img2tri

SIZE, GRAINS, EDGE_LENGTH = 240, 30, 2.5  # px
COPPER = 168.4, 121.4, 75.4  # GPa: C11, C12, C44
TENSION = 100.0  # MPa, along x
Array = NDArray[np.float64]


def polycrystal(seed: int = 5) -> NDArray[np.int64]:
    """Draw grains 1 to 30 that go on across the sides of the image; their seeds are moved to the middles of their cells, three times."""
    places = np.random.default_rng(seed).random((GRAINS, 2)) * SIZE
    centres = np.indices((SIZE, SIZE)).reshape(2, -1).T + 0.5
    for _ in range(3):
        nearest = KDTree(places, boxsize=SIZE).query(centres)[1]
        across = (centres - places[nearest] + SIZE / 2) % SIZE - SIZE / 2
        step = np.stack([np.bincount(nearest, across[:, i], GRAINS) for i in (0, 1)], axis=1)
        places = (places + step / np.bincount(nearest, minlength=GRAINS)[:, None]) % SIZE
    return KDTree(places, boxsize=SIZE).query(centres)[1].reshape(SIZE, SIZE) + 1


def turned_stiffness(angles: Array) -> Array:
    """Stiffness (k, 3, 3) of crystals turned in the plane: stresses xx, yy, xy from strains xx, yy and twice xy."""
    c11, c12, c44 = COPPER
    crystal = np.array([(c11, c12, 0), (c12, c11, 0), (0, 0, c44)])
    c, s = np.cos(angles), np.sin(angles)
    # From strains along x and y to strains along the axes of the crystal; transposed it takes stresses back.
    turn = np.stack([c * c, s * s, c * s, s * s, c * c, -c * s, -2 * c * s, 2 * c * s, c * c - s * s], axis=-1).reshape(-1, 3, 3)
    return turn.transpose(0, 2, 1) @ crystal @ turn


class Sample:
    """Linear triangles with a stiffness each; displacements are x and y of each vertex in turn, (2 n,)."""

    def __init__(self, mesh: img2tri.TriangleMesh, stiffness: Array) -> None:
        self.mesh, self.stiffness = mesh, stiffness
        corners = mesh.vertices[mesh.triangles]
        # The gradient of a corner's shape function is the side across, turned by a right angle, over twice the area.
        across = np.roll(corners, -2, axis=1) - np.roll(corners, -1, axis=1)
        double = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        self.area = (double[0][:, 0] * double[1][:, 1] - double[0][:, 1] * double[1][:, 0]) / 2
        gradient = np.stack([-across[..., 1], across[..., 0]], axis=-1) / (2 * self.area[:, None, None])
        self.strain_of = np.zeros((len(corners), 3, 6))
        self.strain_of[:, 0, 0::2] = self.strain_of[:, 2, 1::2] = gradient[..., 0]
        self.strain_of[:, 1, 1::2] = self.strain_of[:, 2, 0::2] = gradient[..., 1]
        self.unknowns = (2 * mesh.triangles[..., None] + np.arange(2)).reshape(-1, 6)
        blocks = self.area[:, None, None] * (self.strain_of.transpose(0, 2, 1) @ stiffness @ self.strain_of)
        rows, columns = np.repeat(self.unknowns, 6, axis=1).ravel(), np.tile(self.unknowns, 6).ravel()
        self.system = sparse.csc_array((blocks.ravel(), (rows, columns)), shape=(mesh.vertices.size,) * 2)
        x, y = mesh.vertices.T
        none = np.zeros_like(x)
        self.uniform = np.stack([np.stack(u, axis=1).ravel() for u in ((x, none), (none, y), (y / 2, x / 2))], axis=1)

    def strains(self, moved: Array) -> Array:
        """Strain (m, 3, loads) of each triangle."""
        return self.strain_of @ moved[self.unknowns]

    def mean(self, values: Array) -> Array:
        """Mean over the sample of what each triangle has."""
        return np.tensordot(self.area, values, axes=1) / self.area.sum()

    def prescribed(self) -> Array:
        """Displacements (2 n, 3) for three unit strains of the boundary."""
        x, y = self.mesh.vertices.T
        left, bottom, right, top = self.mesh.frame.bounds
        inside = np.flatnonzero(np.repeat((x > left) & (x < right) & (y > bottom) & (y < top), 2))
        free = sparse.csc_array((np.ones(len(inside)), (inside, np.arange(len(inside)))), shape=(2 * len(x), len(inside)))
        return self._relaxed(free)

    def periodic(self) -> Array:
        """Displacements (2 n, 3) for three unit strains on average, the same on opposite sides but for these."""
        n = len(self.mesh.vertices)
        pairs = np.concatenate(list(self.mesh.periodic_pairs.values()))
        graph = sparse.coo_array((np.ones(len(pairs)), pairs.T), shape=(n, n))
        count, group = sparse.csgraph.connected_components(graph, directed=False)
        # All vertices of a group move as one; the group of vertex 0 stays.
        group = np.where(group == group[0], 0, group + (group < group[0]))
        one = (2 * group[:, None] + np.arange(2)).ravel()
        free = sparse.csc_array((np.ones(2 * n), (np.arange(2 * n), one)), shape=(2 * n, 2 * count))[:, 2:]
        return self._relaxed(free)

    def traction(self) -> Array:
        """Displacements (2 n, 3) under three unit stresses of the boundary; vertex 0 is held, and the next may not turn around it."""
        load = np.zeros((self.mesh.vertices.size, 3))
        np.add.at(load, self.unknowns, self.area[:, None, None] * self.strain_of.transpose(0, 2, 1))
        far = int(np.argmax(abs(self.mesh.vertices[:, 0] - self.mesh.vertices[0, 0])))
        free = np.setdiff1d(np.arange(len(load)), [0, 1, 2 * far + 1])
        moved = np.zeros_like(load)
        moved[free] = splu(self.system[free][:, free].tocsc()).solve(load[free])
        return moved

    def _relaxed(self, free: sparse.csc_array) -> Array:
        """Add to uniform strains the displacements, of those that are free, that need the least energy."""
        inner = splu((free.T @ self.system @ free).tocsc())
        return self.uniform - free @ inner.solve(free.T @ (self.system @ self.uniform))

    def stiffnesses(self) -> dict[str, Array]:
        """Effective stiffness (3, 3) by each way of loading, and the bounds of Reuss and Voigt, from the least to the greatest."""
        given, around = (self.mean(self.stiffness @ self.strains(u)) for u in (self.prescribed(), self.periodic()))
        return {
            "Reuss": np.linalg.inv(self.mean(np.linalg.inv(self.stiffness))),
            "tractions": np.linalg.inv(self.mean(self.strains(self.traction()))),
            "periodic": around,
            "displacements": given,
            "Voigt": self.mean(self.stiffness),
        }


def mises(sample: Sample, moved: Array) -> Array:
    """Von Mises stress (m,) in plane strain."""
    strain = sample.strains(moved[:, None])[..., 0]
    sx, sy, t = (sample.stiffness @ strain[..., None])[..., 0].T
    sz = COPPER[1] * (strain[:, 0] + strain[:, 1])
    return np.sqrt(((sx - sy) ** 2 + (sy - sz) ** 2 + (sz - sx) ** 2) / 2 + 3 * t**2)


def draw(sample: Sample, angles: Array, stress: Array, path: Path) -> None:
    """Draw how the grains are turned, and the stress in them."""
    mesh = sample.mesh
    x, y = mesh.vertices.T
    walls = np.concatenate([edges for name, edges in mesh.sets().edges.items() if "__" in name])
    hues = 0.24 + 0.68 * np.sin(np.pi * (np.linspace(0, 1, 180)[:, None] + np.array([0.62, 0.95, 0.28]))) ** 2
    figure = Figure(figsize=(10.4, 4.7), layout="constrained")
    shown = (
        (np.degrees(angles[mesh.regions - 1]), ListedColormap(hues), (0, 90), "turned by, degrees", f"{GRAINS} grains of copper"),
        (stress, "inferno", tuple(np.quantile(stress, (0.002, 0.998))), "von Mises stress, MPa", f"pulled along x with {TENSION:g} MPa"),
    )
    for place, (values, colours, limits, label, title) in enumerate(shown, 1):
        axes = figure.add_subplot(1, 2, place, aspect="equal")
        axes.set_axis_off()
        faces = axes.tripcolor(x, y, mesh.triangles, facecolors=values, cmap=colours, clim=limits, rasterized=True)
        axes.add_collection(LineCollection(mesh.vertices[walls], colors="white", linewidths=0.9))
        axes.set_title(title)
        figure.colorbar(faces, label=label, shrink=0.9, pad=0.02)
    figure.savefig(path, dpi=130)


def main(out: str | Path = "out") -> dict[str, float]:
    """Mesh, compute, compare, draw."""
    folder = Path(out)
    folder.mkdir(parents=True, exist_ok=True)
    mesh = img2tri.mesh_image(polycrystal(), labels=True, background=None, edge_length=EDGE_LENGTH, periodic="xy")
    angles = np.random.default_rng(1).uniform(0, np.pi / 2, GRAINS)  # the crystal looks the same after a quarter turn
    sample = Sample(mesh, turned_stiffness(angles)[mesh.regions - 1])
    found = sample.stiffnesses()

    print(f"{mesh}\n{'GPa':16}{'xx xx':>9}{'yy yy':>9}{'xx yy':>9}{'xy xy':>9}")
    for name, matrix in found.items():
        print(f"{name:16}" + "".join(f"{matrix[i]:9.2f}" for i in ((0, 0), (1, 1), (0, 1), (2, 2))))
    asymmetry = max(abs(matrix - matrix.T).max() / matrix.max() for matrix in found.values())
    # Of two matrices in order no strain takes more energy with the first: the difference has no negative eigenvalue. One is 0, as
    # against expansion all grains are alike, however they are turned.
    steps = np.linalg.eigvalsh(np.diff(np.stack(list(found.values())), axis=0))

    single = turned_stiffness(angles[:1])
    alike = Sample(mesh, np.repeat(single, len(mesh.triangles), axis=0)).stiffnesses()
    patch = max(abs(matrix - single[0]).max() / single.max() for matrix in alike.values())
    print(f"asymmetry {asymmetry:.0e}, patch test (all grains alike) {patch:.0e}, least step between bounds {steps[:, 1].min():.2f} GPa")
    assert asymmetry < 1e-10
    assert patch < 1e-10
    assert steps[:, 0].min() > -1e-9
    assert steps[:, 1].min() > 0

    strain = np.linalg.solve(found["periodic"], [TENSION, 0, 0])  # in thousandths, as the stiffness is in GPa
    stress = mises(sample, sample.periodic() @ strain)
    draw(sample, angles, stress, folder / "polycrystal_stiffness.png")
    return {"kept": float(mesh.report.kept), "asymmetry": asymmetry, "patch": patch, "least_step": float(steps[:, 1].min()),
            "gap": float((found["displacements"] - found["tractions"])[0, 0] / found["periodic"][0, 0])}  # fmt: skip


if __name__ == "__main__":
    main()
