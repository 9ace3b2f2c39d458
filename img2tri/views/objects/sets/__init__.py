"""The named parts of a mesh: regions, sides of the frame, outer boundary, holes, interfaces, and their numbers in files.

named_sets           which edge belongs to which set, and what the sets are called: left, outer, hole_1, bone__cartilage
known_edges          sets read from a file, beside those that are found
split_at_corners     a set of edges -> its connected pieces, cut at corners: left_1, left_2, outer_1
numbers_in_files     labels and names -> the whole numbers that stand for them in files
triangles_by_label   for each label its triangles
"""
