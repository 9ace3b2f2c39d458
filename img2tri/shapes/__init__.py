"""SHAPES: label map -> outlines, shapely polygons, spacing, points.

In the order of the flow:

trace     Label map -> chains: the sides between pixels of different regions, joined in the order in which outlines run.
place     Chains -> dense outlines: where between two pixel centres the outline passes.
sizes     How long edges should be: one size field, and how long the chords of outlines should be.
simplify  Dense outlines -> coarse ones with the wanted edge length, within the tolerance, of the same topology.
periodic  Opposite sides of an image divided alike.
mirror_symmetry  The outlines of a symmetric image -> those of one half of it.
region_pressures  Regions that lack area -> by how much to shift the boundaries between them.
polygons  Outlines -> shapely polygons: one coverage, neighbours sharing their vertices.

Chains are open between two nodes, or rings; they are `img2tri.arrays.ChainIndex` throughout.
"""
