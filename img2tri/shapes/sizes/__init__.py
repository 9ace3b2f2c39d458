"""How long edges should be, before there is a mesh; the sizes inside follow in `img2tri.triangles.generate.interior_sizes`.

user_size_field  The option `edge_length`, if it differs from place to place -> a size field over the image, its growth limited.
outline_sizes    How long the chords of outlines should be, at each dense point: by curvature, by thickness, by the size field.
"""
