"""The certificate of a mesh: what it keeps of what was promised, measured on its triangles against the image it was made from.

report                The certificate itself, `Report`: every promise with its number, its place, and a warning where it is not kept.
outline_distance      Hausdorff distance between outlines and mesh; pixels that lie in a wrong region.
region_areas          Areas of regions, in the mesh and in the image; regions that lie elsewhere.
topology_and_defects  Components, holes, neighbours; inverted or flat triangles, edges of three, vertices where a region touches itself.
edge_sides            Each edge once, and what lies on its sides.
min_angle_check       Which triangles have angles below the promised one, and how small the smallest is.
"""
