"""Pieces of blocks -> a mesh in parts on disk, each part written by the worker that has it; and read back.

vertex_numbers   the proof that each seam edge has one partner, and from it the numbers of vertices in the whole mesh
tile_part        the blocks of a tile -> a part, and what is known of it
part_files       parts in files: zarr, .pvtu
vtkhdf_file      parts in one .vtkhdf file, into which all workers write at once, each in its place
overview_cells   what of a part is seen in a picture of the whole
whole_report     what is known of all parts -> the report of the whole
load_parts       a mesh in parts read back, whole
"""
