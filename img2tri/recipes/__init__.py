"""The ways through the stages: only recipes hand data from one stage to the next.

conforming        Label map -> outlines -> points -> triangles: every region with its own outline, to the promises.
wanted_sizes      What a user says of edge lengths -> the lengths wanted everywhere, in px.
mirrored          One half of a symmetric image meshed by the conforming recipe, and mirrored.
preserved_areas   Coarse outlines -> coarse outlines that enclose, region by region, what the dense ones enclose.
poisson_interior  The inside filled with Poisson-disk points instead of a lattice.
sampling          An image on the grid of a finished mesh -> its values on triangles or vertices.
second_order      A finished mesh -> quadratic triangles (T6) with curved sides along the outlines.
"""
