"""Opposite sides of an image divided alike, so that copies of its mesh, set side by side, fit together.

The labels along two opposite sides have to be the same. Then the chains on these sides are the same too, crossing by crossing: each
entry has its partner on the other side, a *periodic pair*::

      3---o---o---3        an entry of a chain on the left and its partner on the right
      |           |        lie at the same height, to the last bit
      o           o
      2           2        numbers: junctions with outlines that reach the frame

side_labels   The option `periodic` checked: are the labels along opposite sides the same?
pairs         Outlines on opposite sides simplified alike: the finer division of each stretch is taken for both.
vertex_pairs  Vertices of meshes on opposite sides: divided alike, and paired.
"""
