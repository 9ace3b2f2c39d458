"""Turn the knobs and watch the mesh: one viewer, in a browser (`img2tri app`) and in a notebook (`img2tri.explore`).

session       An image and its mesh under changing options: wishes in, bytes for the viewer out. It knows nothing of who asks.
image_facts   What the knobs start from: size, kind, histogram and regions of an image, and its pixels for the mask.
knobs         The options as knobs, and texts typed into them -> values.
downloads     The mesh as the bytes of a file of any format.
app_page      The viewer's page with the knobs beside it.
server        The app: a page and its answers, on this machine only; fetching.js asks it.
explore       The notebook: a widget whose `mesh` is the present one; widget.js asks its kernel.

Beside them: knobs.html and knobs.css, what stands beside the viewer; knob_panel.js, what the knobs show, and knobs.js, what they do. The
viewer itself is that of `img2tri.views.page`.
"""
