"""A mesh as a picture, by matplotlib or as a small SVG.

plot             A plane mesh, its image and its quality -> a `matplotlib` Figure, and if wanted a PNG, SVG or PDF file.
overview         A mesh too large to be drawn edge by edge -> a picture of its regions and one of its worst angles.
figure_parts     The parts of a figure: the place for the mesh and the one for its quality, and what is drawn in either.
notebook         A mesh in a notebook: vertices, triangles, regions -> a small SVG, and a piece of HTML with a line of numbers below it.
region_colours   Colours for regions: a count -> that many colours, each well apart from those before it.
image_png        An array -> the bytes of a PNG file.
"""
