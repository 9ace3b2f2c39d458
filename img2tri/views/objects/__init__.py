"""A mesh as objects of other libraries, and the geometry these share.

What all views start from:

    flat_or_extruded       checks the arrays; the triangles in space: flat at a height z, or the closed surface of a solid
    half_edge_twins        for each side of a triangle the same edge as its neighbour has it (half-edge twins)
    extruded_surface       a plane mesh with a thickness, for printing: the closed surface of bottom, top and walls, all triangles
    body_per_region        one closed body for each region, for printing in several materials; a trimesh.Scene of them
    base_plate             a plate under the mesh that joins loose parts
    extruded_wedges        a plane mesh with a thickness, for solvers: volume elements (wedges) in layers; nodes in the middle of edges
    sets/                  the named parts: left, outer_1, hole_1, bone__cartilage, and their numbers
    solver_cells           cells of one kind with all their named parts: what every format for solvers starts from
    tetrahedra             these wedges cut into tetrahedra
    periodic_solver_nodes  the nodes of periodic cells that are the same place
    region_borders         which edges bound the mesh or part two regions

Objects of libraries:

    to_trimesh  trimesh.Trimesh
    to_pyvista  pyvista.PolyData and UnstructuredGrid
    to_skfem    skfem.MeshTri
"""
