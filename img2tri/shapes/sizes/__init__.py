"""How long edges should be.

user_size_field     What a user says of edge lengths -> a size field over the image, whose growth is limited.
outline_sizes  How long the chords of outlines should be, at each dense point.
"""
