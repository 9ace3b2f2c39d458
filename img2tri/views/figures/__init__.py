"""A mesh to look at: figures, pages, notebooks.

colours      Colours for regions: a count -> that many colours, each well apart from those before it.
histogram    How many triangles have which quality: one number per triangle -> a chart as an SVG inside a page, without any library.
html_page    A page about a mesh: the mesh, its image and its certificate -> one HTML file that needs nothing but itself.
html_tables  What a page about a mesh says in words and tables: the certificate, as plain data -> pieces of HTML.
notebook     A mesh in a notebook: vertices, triangles, regions -> a small SVG, and a piece of HTML with a line of numbers below it.
panels       The parts of a figure: a page with a place for the mesh and one for its quality, and what is drawn in either.
plot         Figures: a plane mesh, its image and its quality -> a `matplotlib` Figure, and if wanted a PNG, SVG or PDF file.
png          An image as the bytes of a PNG file: an array -> 8 bits per channel, compressed.
"""
