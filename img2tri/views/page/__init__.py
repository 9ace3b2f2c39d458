"""A page about a mesh: one HTML file that needs nothing but itself.

html_page      The mesh, its image and its certificate -> the file; page.html and page.js beside it are its frame and its script.
html_tables    What the page says in words and tables: the certificate, as plain data -> pieces of HTML.
histogram_svg  How many triangles have which quality: one number per triangle -> a chart as an SVG.
image_png      An array -> the bytes of a PNG file.
"""
