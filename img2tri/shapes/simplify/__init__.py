"""Dense outlines -> coarse ones with the wanted edge length, within the tolerance, of the same topology.

In the order of the flow:

simplification         A simplification: which dense points are kept as vertices, and how far each is offset; evenly spaced at first.
sharp_turns            Where an outline turns sharply without a corner: a vertex there spares short chords.
parted_junctions       Junctions nearer to each other than chords should be short, moved apart.
vertex_offsets         Vertices offset along the normal, so that few chords approximate the outline.
tolerance              Chords split until each is within the tolerance, clear of the others, and not too sharp.
clearance              Which chords come too near to each other, or meet at too sharp an angle.
area_preservation      Coarse outlines that enclose what the dense ones enclose.
closer_spacing         More vertices, evenly, where what can be offset does not do for the area of a region.
set_back               Dense outlines set back to the middles of their crack edges near some places, where pixels are not square.
tangential_relocation  Vertices that slide along their outline, for the sake of the triangles beside them.
"""
