"""Outlines -> triangles: the mesh is made here, in the order of `filling`.

filling               All of it, in two halves: begin, and finish.
interior_sizes        How long edges inside should be, growing from short chords and user sizes at a limited rate (the size function).
pslg                  The planar straight-line graph of the outlines; its segments divided to the wanted length.
first_layer           Points in front of the outlines, as in advancing-front meshing.
hexagonal_lattice     The lattice inside, and its core of equilateral triangles, written down as a template.
graded_lattice        Nested lattices: finer nodes where shorter edges are wanted.
strip                 What lies between outlines and core: triangulated, smoothed, joined with the core.
constrained_delaunay  Constrained Delaunay triangulation, regions by votes, and Ruppert's refinement.
quality_smoothing     Vertices move so that triangles become equilateral; the worst angles first.
vertex_sums           Sums over the corners of triangles, vertex by vertex.
valence_repair        Vertices with too many or too few triangles are split or removed.
ruppert_refinement    The safety net: Ruppert's refinement in a patch around too small angles.
"""
