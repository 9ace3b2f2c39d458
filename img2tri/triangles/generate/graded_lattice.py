"""Nested hexagonal lattices: the nodes that make a lattice finer where edges should be shorter.

In: a hexagonal lattice and the size function. Out: the nodes of finer lattices that follow it. A hexagonal lattice of pitch a and the
centres of its triangles are together a hexagonal lattice of pitch a / sqrt 3, turned by 30 degrees (sqrt-3 nesting, as in the subdivision
of L. Kobbelt, SIGGRAPH 2000, https://doi.org/10.1145/344779.344835). So each lattice contains all coarser ones, and a node has three
children: itself, and the centres of two of its triangles. Where one lattice ends and a coarser one goes on, the nodes of both fit: none
has to be dropped.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from img2tri.arrays import Bools, Floats, Ints, Points
from img2tri.errors import bounded
from img2tri.triangles.generate.hexagonal_lattice import Lattice
from img2tri.triangles.generate.interior_sizes import SizeFunction

RATIO = 3**0.5  # of pitches, from one lattice to the next
LONGEST = 1.36
"""A lattice is used where the wanted length is less than this times its pitch: a little later than half-way to the next one by ratio,
3^(1/4) = 1.316. Where lengths grow, later means more triangles, and better ones: mean q .972, .977, .978 at 1.2, 1.316, 1.36."""
LEVELS = 100  # of lattices: pitches down to 1e-24 of the coarsest


def lengths_near(
    places: Points, lengths: Floats, largest: float, gradation: float, field: Callable[[Floats], Floats] | None = None
) -> SizeFunction:
    """Make a size function with those places as sources where the length is short enough to call for a finer lattice."""
    short = lengths < largest * LONGEST / RATIO
    return SizeFunction(largest, gradation, places[short], lengths[short], field)


def reaches(sizes: SizeFunction) -> Floats:
    """How far (k,) from each source of a size function a finer lattice may be needed."""
    return ((LONGEST + sizes.gradation) / RATIO * sizes.largest - sizes.lengths) / sizes.gradation


def finer(lattice: Lattice, nodes: Ints, sizes: SizeFunction) -> tuple[Ints, Points, Floats]:
    """Find the nodes of finer lattices that are needed among those given of the coarsest.

    Returns
    -------
    busy : (b,) int64
        The given nodes that have finer ones around.
    points : (p,) complex
        The finer nodes.
    wanted : (p,) float64
        Wanted edge length at each.
    """
    pitch, turn = lattice.pitch, np.exp(1j * np.pi / 6)
    points = lattice.positions(nodes)
    wanted = sizes.at(points)
    divided = _divided(wanted, pitch, sizes)
    busy = nodes[divided]
    needed, lengths = [np.zeros(0, np.complex128)], [np.zeros(0)]
    for _ in bounded("nested lattices", LEVELS):
        if not divided.any():
            break
        points, wanted = points[divided], wanted[divided]
        # The next lattice: the same nodes, and the centres of two triangles at each.
        pitch /= RATIO
        children = (points[:, None] + pitch * turn * np.array([1, np.exp(1j * np.pi / 3)])).ravel()
        turn *= np.exp(1j * np.pi / 6)
        theirs = sizes.at(children)
        kept = theirs < LONGEST * pitch
        needed.append(children[kept])
        lengths.append(theirs[kept])
        points, wanted = np.concatenate([points, children]), np.concatenate([wanted, theirs])
        divided = _divided(wanted, pitch, sizes)
    return busy, np.concatenate(needed), np.concatenate(lengths)


def _divided(wanted: Floats, pitch: float, sizes: SizeFunction) -> Bools:
    """Which nodes may have children that are needed: these lie pitch / RATIO away, where the wanted length is little less."""
    divided: Bools = wanted < (LONGEST + sizes.gradation) * pitch / RATIO
    return divided
