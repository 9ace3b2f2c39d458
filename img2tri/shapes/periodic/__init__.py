"""Opposite sides of an image divided alike, so that copies of its mesh, set side by side, fit together.

The image repeats after as many pixels as it has. The chains along opposite sides are cut at the same places, and then are the same where
both sides are meshed, crossing by crossing: each entry has its partner on the other side, a *periodic pair*::

      3---o---o---3        an entry of a chain on the left and its partner on the right
      |           |        lie at the same height, to the last bit
      o           o
      2           2        numbers: junctions with outlines that reach the frame

side_chains           The option `periodic` checked; chains along opposite sides cut at the same places.
paired_outlines       While outlines are simplified: opposite sides alike, the finer division of each stretch taken for both.
paired_mesh_vertices  In the finished mesh: vertices on opposite sides divided alike, and which is whose partner.
"""
