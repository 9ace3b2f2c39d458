"""Chains -> dense outlines: where between two pixel centres the outline passes.

constrained_smoothing  Smoothing along the arc, crossing by crossing as far as the pixels allow: the widest spline that fits.
corners                Where an outline has a corner, and where exactly it is.
iso_crossings          Gray values -> where on its link each crossing lies, and how surely.
padded_chains          Chains unrolled on one line, so that smoothing along all of them is one convolution.
placement              Links -> dense outlines: where between two pixel centres the outline passes.
smoothing_splines      Smoothing splines along chains of points: the smooth curve of a scale, and what else follows the arc.
"""
