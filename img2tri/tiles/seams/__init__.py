"""A new mesh fitted to finished pieces: with no vertex hanging and no triangle twice.

piece_seams        the triangles of one block, and its seam: the edges where other blocks go on
join_blocks       `merge`: where the new mesh and finished pieces agree it goes on, else there is a gap to fill
block_core         what of a new mesh is too far from others to be looked at
both_meshes        both in the same numbers, and the territory of a block
outline_check      new edges along outlines: how far these are from the image's, and the image's from these
joint_check        vertices that are doubled, regions that touch themselves where pieces meet
gap_attempts       the ways of filling a gap, from the gentlest on: how wide it is, how long edges are, what is given up
outline_splices    outlines joined across a gap
gap_triangulation  a gap triangulated, smoothed, refined
"""
