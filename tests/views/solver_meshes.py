"""Meshes for the tests of what goes to solvers, one of each kind of cell, and how to find other programs."""

from __future__ import annotations

import shutil
import subprocess

import numpy as np
import pytest
from views.plates import cells

from img2tri.views.formats.solvers.vtu_vtkhdf import to_grid
from img2tri.views.objects.extruded_wedges import quadratic, wedges
from img2tri.views.objects.solver_cells import flat_cells, solid_cells
from img2tri.views.objects.tetrahedra import tetrahedra

KINDS = ("triangle", "triangle6", "wedge", "wedge15", "tetra", "tetra10")
HEIGHT, LAYERS = 1.25, 2
NAMES = {4: "bone"}
TEXTS = {"units": "mm", "img2tri": '{"edge": "--8px", "long": "' + "x" * 200 + '"}'}

# Sizes of all parts of the plate below, in units of its cells: areas of regions, lengths of sets.
PLATE = np.array([[1, 1, 1, 1, 1], [1, 0, 1, 0, 1], [1, 1, 1, 0, 1], [1, 1, 1, 1, 1]], bool)
AREAS = {"region_-1": 7, "bone": 10}
LENGTHS = {"left": 4, "bottom": 5, "outer": 5 + 4, "hole_1": 6, "hole_2": 4, "region_-1__bone": 3, "outer_1": 4, "outer_2": 5}
PIECES = ("outer_1", "outer_2")  # right and top
TAGS = {"left": 1001, "bottom": 1003, "outer": 1005, "z_min": 1006, "z_max": 1007, "hole_1": 1011, "hole_2": 1012}
TAGS |= {"region_-1__bone": 1013, "outer_1": 1014, "outer_2": 1015}
SIZE = 0.3  # of a cell: no coordinate but 0 has an end in binary
CORNER = (-0.7, 0.1)


def plate():
    """Five by four cells with two holes, regions -1 (left) and 4, at the lower left of an image of six by five.

    ::

        a a b b b
        a a b . b      rows from the top; the hole on the right is the larger one
        a . b . b
        a a b b b
    """
    vertices, triangles = cells(PLATE)
    regions = np.where(vertices[triangles].mean(axis=1)[:, 0] < 2, -1, 4)
    return vertices * SIZE + CORNER, triangles, regions


BOUNDS = (CORNER[0], CORNER[1], CORNER[0] + 6 * SIZE, CORNER[1] + 5 * SIZE)


def made(kind, **options):
    """The plate as cells of a kind; solids in two layers."""
    vertices, triangles, regions = plate()
    order = 2 if kind in ("triangle6", "wedge15", "tetra10") else 1
    nodes, elements = (vertices, triangles) if order == 1 else quadratic(vertices, triangles)
    options = {"names": NAMES, "bounds": BOUNDS, "field_data": TEXTS, "z": 0.5, **options}
    flat = flat_cells(nodes, elements, regions, **options)
    if kind.startswith("triangle"):
        return flat
    solid = solid_cells(flat, *wedges(vertices, triangles, height=HEIGHT, layers=LAYERS, order=order, z=0.5)[:2])
    return tetrahedra(solid) if kind.startswith("tetra") else solid


def sizes(solid):
    """Name -> area or volume of regions, and length or area of sets."""
    thick = HEIGHT if solid else 1
    regions = {name: area * SIZE**2 * thick for name, area in AREAS.items()}
    sets = {name: length * SIZE * thick for name, length in LENGTHS.items()}
    return regions, sets | ({name: sum(AREAS.values()) * SIZE**2 for name in ("z_min", "z_max")} if solid else {})


def program(name):
    """The path of a program; a skip that names it where there is none."""
    path = shutil.which(name)
    if path is None:
        pytest.skip(f"{name} is not installed")
    return path


def gmsh():
    """Gmsh, for Python; a skip that says why where it does not load."""
    try:
        import gmsh
    except (ImportError, OSError) as problem:
        pytest.skip(f"gmsh is not installed, or lacks a library: {problem}")
    return gmsh


def python_with(module):
    """The Python of the system, if it has a module; a skip that names it where it has not."""
    python = "/usr/bin/python3"
    if not shutil.which(python) or subprocess.run([python, "-c", f"import {module}"], capture_output=True, check=False).returncode:
        pytest.skip(f"{module} is not installed for {python}")
    return python


def elements(vertices, triangles, regions=None, *, height=None, layers=1, order=1, z=0.0, **options):
    """Cells of a plane mesh as an object of pyvista: flat, or wedges."""
    nodes, cells = (vertices, triangles) if order == 1 else quadratic(vertices, triangles)
    flat = flat_cells(nodes, cells, regions, z=z, **options)
    if height is None:
        return to_grid(flat)
    return to_grid(solid_cells(flat, *wedges(vertices, triangles, height=height, layers=layers, order=order, z=z)[:2]))
