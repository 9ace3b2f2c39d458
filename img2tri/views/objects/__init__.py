"""A mesh as objects of other libraries, and the geometry these share.

What all views start from:

    flat_or_extruded  checks the arrays; the triangles in space: flat at a height z, or the closed surface of a solid
    side_twins        triangles -> the same edge as the neighbour has it
    extrusion         triangles and a height -> the closed surface: bottom, top and walls
    body_per_region   one closed body for each region, for printing in several materials; a trimesh.Scene of them
    base_plate        a plate under the mesh that joins loose parts
    wedges            triangles and a height -> wedges in layers; quadratic elements: nodes in the middle of edges
    sets/             the named parts: left, outer_1, hole_1, bone__cartilage, and their numbers
    solver_cells      cells of one kind with all their named parts: what every format for solvers starts from
    tetrahedra        wedges cut into tetrahedra
    periodic_nodes    the nodes of periodic cells that are the same place
    region_borders    which edges bound the mesh or part two regions

Objects of libraries:

    to_trimesh        trimesh.Trimesh
    to_pyvista        pyvista.PolyData and UnstructuredGrid
    to_skfem          skfem.MeshTri
"""
