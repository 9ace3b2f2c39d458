"""The named parts of a mesh: regions, sides of the frame, outer boundary, holes, interfaces, and their numbers in files.

named_sets   triangles with their regions -> the sets, with their edges and names
set_pieces   left_1, left_2, outer_1: the pieces of a set, cut at corners
set_numbers  the numbers of regions and sets in files
index_by_value     for each label its triangles
"""
