"""Chains -> dense outlines: where between two pixel centres the outline passes.

In the order of the flow:

placement              Dual edges -> dense outlines, by the files below.
known_crossings        What an image says of the places of its outlines -> where each crossing lies, by one of the next two.
iso_crossings          Gray values -> where on its dual edge each crossing lies, and how surely.
colour_crossings       Pixels mixed of two flat colours -> where each crossing lies, and how surely.
outline_corners        Where an outline has a corner, and where exactly it is.
constrained_smoothing  Each crossing onto the widest smoothing spline that fits its bounds; then each chain to its area.
straight_chains        Open chains that may be straight lines, onto these lines.
area_exchange          Regions that lack area get it by whatever chain of theirs has room.
node_placement         Nodes where the chains that meet there lead, and chains bent to end at their nodes.
smoothing_splines      The smooth curve of a scale through the points of chains.
along_the_arc          Distances from marked places of chains, and values that fade to both sides.
padded_chains          Chains continued beyond their ends and laid out on one line.
"""
