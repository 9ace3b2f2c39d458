"""How long edges should be: one size function, limited in growth.

outline_sizes  How long the pieces of outlines should be, at each dense point.
size_field     What a user says of edge lengths -> a field of lengths over the image, whose growth is limited.
"""
