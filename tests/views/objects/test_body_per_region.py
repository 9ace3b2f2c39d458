from __future__ import annotations

import io

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as nps
from oracles import areas
from views.plates import STRIP_AREA, cells, is_closed, strip, volume

from img2tri.errors import MeshError, ParameterError
from img2tri.views.objects.body_per_region import bodies, to_scene, unique_names


def quarters():
    """A plate, 4 by 4, of four regions around its middle and one in the middle of these; one of them in two parts."""
    mask = np.ones((4, 4), bool)
    vertices, triangles = cells(mask)
    x, y = np.floor(vertices[triangles].mean(axis=1)).T
    regions = 1 + (x >= 2) + 2 * (y >= 2)
    regions[(np.abs(x - 1.5) < 1) & (np.abs(y - 1.5) < 1)] = 9
    regions[(x == 0) & (y == 0)] = 2
    return vertices * [1, 1.1] + 0.3, triangles, regions.astype(int)


def faces_at(surface):
    """Each face as its three places, beginning with the least, so that the way it is wound shows."""
    corners = [[tuple(p) for p in face] for face in surface.points[surface.faces].tolist()]
    return {tuple(c[(c.index(min(c)) + k) % 3] for k in range(3)) for c in corners}


def mirrored(face):
    return (face[0], face[2], face[1])


def test_every_region_is_a_closed_body_of_its_own_volume():
    vertices, triangles, regions = quarters()
    made = bodies(vertices, triangles, regions, height=2.5, z=1)
    assert [body.label for body in made] == [1, 2, 3, 4, 9]
    for body in made:
        s = body.surface
        assert is_closed(s.faces)
        assert s.closed
        assert volume(s.points, s.faces) == pytest.approx(areas(vertices, triangles)[regions == body.label].sum() * 2.5, rel=1e-12)
        assert set(s.regions.tolist()) == {body.label}
        assert (s.points[:, 2].min(), s.points[:, 2].max()) == (1, 3.5)
        assert np.array_equal(np.unique(s.faces), np.arange(len(s.points)))
    total = sum(volume(body.surface.points, body.surface.faces) for body in made)
    assert total == pytest.approx(areas(vertices, triangles).sum() * 2.5, rel=1e-12)


def test_neighbours_share_their_walls_triangle_by_triangle():
    vertices, triangles, regions = quarters()
    found = {body.label: faces_at(body.surface) for body in bodies(vertices, triangles, regions, height=1)}
    shared = {(a, b): {f for f in found[a] if mirrored(f) in found[b]} for a in found for b in found if a < b}
    edges = {(1, 2): 3, (1, 3): 1, (1, 9): 2, (2, 4): 1, (2, 9): 2, (3, 4): 1, (3, 9): 2, (4, 9): 2}
    assert {pair: len(faces) for pair, faces in shared.items() if faces} == {pair: 2 * n for pair, n in edges.items()}
    # What is not shared is bottom, top, and the outer wall.
    outside = set().union(*found.values()) - {f for a in found for b in found if a != b for f in found[a] if mirrored(f) in found[b]}
    walls = [f for f in outside if len({p[2] for p in f}) == 2]
    assert len(walls) == 2 * 16
    ends = np.array([[p[:2] for p in f] for f in walls])
    edge = ((ends == vertices.min(axis=0)) | (ends == vertices.max(axis=0))).all(axis=1).any(axis=1)
    assert edge.all()


@given(nps.arrays(int, st.tuples(st.integers(1, 5), st.integers(1, 5)), elements=st.integers(0, 3)).filter(np.any))
def test_any_labels_become_bodies_that_fit(labels):
    """Also where a region touches itself in a vertex, as in a checkerboard."""
    vertices, triangles = cells(labels > 0)
    middle = np.floor(vertices[triangles].mean(axis=1)).astype(int)
    regions = labels[middle[:, 1], middle[:, 0]]
    made = bodies(vertices, triangles, regions, height=0.5)
    assert [body.label for body in made] == np.unique(regions).tolist()
    for body in made:
        assert is_closed(body.surface.faces)
        assert volume(body.surface.points, body.surface.faces) == pytest.approx((labels == body.label).sum() / 2)
    # Each wall upright between two regions is there twice, wound against itself; all walls together leave the outline of the whole.
    every = [face for body in made for face in faces_at(body.surface)]
    alone = set(every) - {mirrored(face) for face in every}
    whole = trimesh.Trimesh(*_soup(alone), process=True)
    assert whole.volume == pytest.approx((labels > 0).sum() / 2)


def _soup(faces):
    corners = np.array(sorted(faces)).reshape(-1, 3)
    return corners, np.arange(len(corners)).reshape(-1, 3)


def test_scene_for_trimesh():
    vertices, triangles, regions = strip()
    q = np.linspace(0.5, 1, len(triangles))
    scene = to_scene(
        vertices, triangles, regions, height=2, names={3: "bone", 7: "cartilage"}, cell_data={"q": q}, field_data={"units": "mm"}
    )
    assert isinstance(scene, trimesh.Scene)
    assert list(scene.geometry) == ["bone", "cartilage"]
    assert set(scene.graph.nodes_geometry) == {"bone", "cartilage"}
    for label, body in zip((3, 7), scene.geometry.values(), strict=True):
        assert body.is_watertight
        assert body.is_winding_consistent
        assert body.volume == pytest.approx(STRIP_AREA)
        assert body.metadata["region"] == label
        assert set(body.face_attributes["region"].tolist()) == {label}
        assert set(body.face_attributes["q"].tolist()) == set(q[regions == label].tolist())
        assert body.units == "mm"
    assert scene.units == "mm"
    assert scene.metadata["regions"] == {"bone": 3, "cartilage": 7}
    assert scene.volume == pytest.approx(2 * STRIP_AREA)
    first, second = (tuple(body.visual.face_colors[0].tolist()) for body in scene.geometry.values())
    assert first != second
    whole = scene.to_mesh()
    assert whole.volume == pytest.approx(2 * STRIP_AREA)


def test_a_scene_survives_a_glb():
    scene = to_scene(*strip(), height=2, names={3: "bone"})
    read = trimesh.load_scene(io.BytesIO(scene.export(file_type="glb")), file_type="glb")
    assert set(read.geometry) == {"bone", "region_7"}
    for body in read.geometry.values():
        body.merge_vertices(merge_norm=True, merge_tex=True)
        assert body.is_watertight
        assert body.volume == pytest.approx(STRIP_AREA, rel=1e-6)


def test_without_a_height_parts_are_flat():
    vertices, triangles, regions = strip()
    scene = to_scene(vertices, triangles, regions, height=None, z=2)
    for body in scene.geometry.values():
        assert not body.is_watertight
        assert body.area == pytest.approx(STRIP_AREA / 2)
        assert np.all(body.vertices[:, 2] == 2)
    left, right = ({tuple(p) for p in scene.geometry[name].vertices.tolist()} for name in ("region_3", "region_7"))
    assert len(left & right) == 2


def test_names_are_never_the_same():
    made = bodies(*quarters(), height=1, names={1: "grain", 2: "grain", 3: "region_4"})
    assert [body.name for body in made] == ["grain_1", "grain_2", "region_4_3", "region_4_4", "region_9"]
    assert len({body.colour for body in made}) == 5
    assert unique_names([1, 2, 3], {1: "a", 2: "a", 3: "a_1"}) == {1: "a_1_1", 2: "a_2", 3: "a_1"}


def test_without_regions_there_is_one_body():
    (body,) = bodies(*strip()[:2], height=1)
    assert (body.label, body.name) == (1, "region_1")


def test_the_arguments_are_left_as_they_are():
    vertices, triangles, regions = quarters()
    before = vertices.copy(), triangles.copy(), regions.copy()
    bodies(vertices, triangles, regions, height=1)
    assert all(np.array_equal(a, b) for a, b in zip(before, (vertices, triangles, regions), strict=True))


def test_what_cannot_be_is_refused():
    with pytest.raises(ParameterError, match="height: expected a number above 0, found 0"):
        to_scene(*strip(), height=0)
    with pytest.raises(ParameterError, match="z: expected a number"):
        to_scene(*strip(), height=1, z=np.inf)
    with pytest.raises(MeshError, match="regions: expected one number"):
        bodies(*strip()[:2], [1], height=1)
