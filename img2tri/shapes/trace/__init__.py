"""Label map -> chains: the sides between pixels of different regions, joined in the order in which outlines run.

crack_edges       Label map -> crack edges, and how they follow each other.
chains            Crack edges -> chains from node to node, or rings.
dual_edges        Chains, laid out in the plane: between which bounds the points of an outline may lie.
nonsquare_pixels  Pixels that are not square: more points, where long crack edges turn.
"""
