"""scikit-fem finds the parts of a mesh by their names."""

from __future__ import annotations

import sys

import numpy as np
import pytest
import specimens

from img2tri import FileError, mesh_image

pytest.importorskip("skfem")


def test_parts_have_their_names_and_sizes():
    from skfem import Basis, ElementTriP1, FacetBasis, Functional, asm

    mesh = mesh_image(specimens.polycrystal(), labels=True, edge_length=6, names={1: "first"})
    fem, sets = mesh.to_skfem(), mesh.sets()
    assert set(fem.subdomains) == set(sets.regions)
    assert set(fem.boundaries) == set(sets.edges)
    one = Functional(lambda w: 1.0 + 0 * w.x[0])
    assert asm(one, Basis(fem, ElementTriP1(), elements="first")) == pytest.approx(mesh.report.areas[1]["mesh"])
    for name, edges in sets.edges.items():
        length = np.linalg.norm(np.diff(mesh.vertices[edges], axis=1), axis=2).sum()
        facets = FacetBasis(fem, ElementTriP1(), facets=np.asarray(fem.boundaries[name], np.int64))
        assert asm(one, facets) == pytest.approx(length), name


def test_vertices_and_triangles_are_those_of_the_mesh():
    mesh = mesh_image(specimens.disc(), edge_length=5)
    fem = mesh.to_skfem()
    assert np.array_equal(fem.p.T, mesh.vertices)
    assert np.array_equal(np.sort(fem.t.T, axis=1), np.sort(mesh.triangles, axis=1))


def test_without_scikit_fem_it_says_how_to_install_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "skfem", None)
    with pytest.raises(FileError, match=r"to_skfem: expected scikit-fem to be installed, found it is not; pip install 'img2tri\[fem\]'"):
        mesh_image(specimens.disc(), edge_length=5).to_skfem()
