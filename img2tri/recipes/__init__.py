"""The ways through the stages: only recipes hand data from one stage to the next.

conforming        The conforming recipe: label map -> outlines -> points -> triangles, every region with its own outline.
poisson_interior  Coarse outlines -> triangles, with points inside scattered by chance: the paper's interior between conforming outl
second_order      Straight triangles -> quadratic ones, with curved sides along the outlines: three corners and three nodes in the m
"""
