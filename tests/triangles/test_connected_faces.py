"""Which triangles hang together, and what spreads among them, against a walk from triangle to triangle."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from img2tri.triangles.connected_faces import connected_faces, spread


@st.composite
def joined_triangles(draw):
    """Random pairs of sides joined, each side once, no triangle to itself or twice to another."""
    m = draw(st.integers(1, 12))
    sides = draw(st.permutations(range(3 * m)))
    neighbours = np.full(3 * m, -1, np.int32)
    for one, other in zip(*[iter(sides[: 2 * draw(st.integers(0, 3 * m // 2))])] * 2, strict=True):
        if one // 3 != other // 3 and one // 3 not in neighbours[other // 3 * 3 :][:3]:
            neighbours[one], neighbours[other] = other // 3, one // 3
    return neighbours.reshape(m, 3)


def walked(neighbours, start):
    found, waiting = {start}, [start]
    while waiting:
        new = {t for t in neighbours[waiting.pop()].tolist() if t >= 0} - found
        found |= new
        waiting += new
    return found


@given(joined_triangles(), st.data())
def test_faces_are_what_a_walk_reaches_and_values_spread_over_all_of_them(neighbours, data):
    m = len(neighbours)
    faces = [walked(neighbours, t) for t in range(m)]
    assert [set(np.flatnonzero(connected_faces(neighbours) == number).tolist()) for number in connected_faces(neighbours)] == faces
    seeds = data.draw(st.sets(st.integers(0, m - 1)))
    values, known = np.full(m, -1), np.zeros(m, bool)
    for seed in seeds:
        values[seed], known[seed] = min(faces[seed]), True  # the same for all of a face
    spread(neighbours, values, known)
    assert values.tolist() == [min(face) if face & seeds else -1 for face in faces]
    assert known.tolist() == [bool(face & seeds) for face in faces]
