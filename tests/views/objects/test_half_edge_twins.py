"""Twins of half-edges, against a dictionary of directed edges."""

import numpy as np
import pytest
from scipy.spatial import Delaunay

from img2tri.errors import MeshError
from img2tri.views.objects.half_edge_twins import half_edge_twins


@pytest.mark.parametrize("seed", range(5))
def test_the_twin_of_a_side_runs_the_other_way(seed):
    rng = np.random.default_rng(seed)
    triangles = Delaunay(rng.random((40, 2))).simplices.astype(np.int64)
    triangles = triangles[rng.random(len(triangles)) < 0.7]  # with holes
    directed = {(int(t[k]), int(t[(k + 1) % 3])): 3 * i + k for i, t in enumerate(triangles) for k in range(3)}
    assert half_edge_twins(triangles).tolist() == [directed.get((end, start), -1) for start, end in directed]


def test_two_triangles_along_a_side_in_the_same_direction_are_refused():
    with pytest.raises(MeshError, match="found 1 that run along a side"):
        half_edge_twins(np.array([[0, 1, 2], [0, 1, 3]]))
    with pytest.raises(MeshError, match="at most two triangles"):
        half_edge_twins(np.array([[0, 1, 2], [1, 0, 3], [0, 1, 4]]))
