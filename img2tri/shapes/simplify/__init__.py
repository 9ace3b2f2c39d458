"""Dense outlines -> coarse ones with the wanted edge length, within the tolerance, of the same topology.

area_preservation      Coarse outlines that enclose what the dense ones enclose.
clearance              Which pieces of outlines come too near to each other, or meet at too sharp an angle.
simplification         Outlines in coarsening: the dense outlines, and which of their points are kept, moved where.
tangential_relocation  Breaks that slide along their outline, for the sake of the triangles beside them.
tolerance              Dense outlines -> outlines with the wanted spacing, the topology kept.
vertex_offsets         Breaks moved sideways, so that few pieces stand well for their runs.
"""
