"""Outlines -> triangles: the mesh is made here.

constrained_delaunay  Constrained Delaunay triangulation, and the proof that its faces are the regions they should be.
filling               Fill a network of outlines with triangles: the inside of the mesh.
first_layer           The first layer of points in front of the outlines.
graded_lattice        How long the edges should be at each place, and the nodes that make a lattice finer where they should be short
hexagonal_lattice     The hexagonal lattice inside of the outlines, and the triangles of its depth, which need no triangulation.
local_refinement      The net under the mesh: where an angle is too small, the triangles around it are refined by Ruppert's method.
pslg                  The network of outlines, and its segments divided to the wanted edge length.
quality_smoothing     Moving vertices so that triangles become as equilateral as they can.
strip                 The band between the outlines and the depth of the lattice: its points, its triangles, and the mesh that both
valence_repair        Adding and removing points where a vertex has too many or too few triangles.
"""
