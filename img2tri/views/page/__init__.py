"""A page about a mesh: one HTML file that needs nothing but itself.

html_page      The mesh, its image and its certificate -> the file. Beside it: page.html, around what is in body.html; page.css.
html_tables    What the page says in words and tables: the certificate, as plain data -> pieces of HTML.
histogram_svg  How many triangles have which quality: one number per triangle -> a chart as an SVG.
packing        The mesh as bytes a browser takes for arrays.
drawing.js     These bytes -> the mesh, and bitmaps of it; camera.js is the part that is seen, viewer.js moves and marks it;
               page.js is what is around it; standalone.js begins where all is in the page.

The app and the notebook (`img2tri.app`) show the same page with knobs.
"""
