r"""Junctions nearer to each other than chords should be short -> moved apart, as far as the tolerance allows.

Where four regions meet in a point, pixels make two junctions of it, anywhere from a tenth of a pixel to two apart. An edge of that length
has to be in the mesh, as the two regions beside it are neighbours, and triangles around it have to grow from there::

     \     /            \     /
      \   /              \   /
       .-.       ->      .---.       some 300 triangles, and 100
      /   \              /   \
     /     \            /     \
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from img2tri.arrays import Floats
from img2tri.shapes.simplify.simplification import Simplification
from img2tri.shapes.simplify.vertex_offsets import MOST_OFFSET

JUNCTIONS_APART = 1.5  # px, as far as junctions are moved apart: the most that blocks side by side can do without leaving them far behind


def part_junctions(s: Simplification, *, spacing: Floats, tolerance: float) -> Simplification:
    """Move junctions at both ends of a short chain apart, to `JUNCTIONS_APART` or the spacing (k,) wanted there, whichever is less.

    Each goes half of what lacks, within its block, where any place is as right as far as topology goes, and no farther than a vertex
    may be offset; one that has several others beside it goes the mean of their ways. Where pixels are not square all stay: outlines go
    back to their middles there, see `set_back`.
    """
    chains, dual_edges = s.chains, s.dual_edges
    one, other = chains.ends
    z = np.zeros(len(dual_edges.middle), np.complex128)
    z[chains.indices] = s.dense
    apart = np.minimum(JUNCTIONS_APART, spacing[chains.first])
    junction = dual_edges.is_junction
    near = np.flatnonzero(junction[one] & junction[other] & (one != other) & (np.abs(z[other] - z[one]) < apart))
    if not len(near) or abs(dual_edges.pixel.real) != abs(dual_edges.pixel.imag):
        return s
    one, other, apart = one[near], other[near], apart[near]
    # The way from block to block tells too, where places are hardly apart.
    way = z[other] - z[one] + dual_edges.middle[other] - dual_edges.middle[one]
    way /= np.maximum(np.abs(way), 1e-12)
    by = np.maximum(apart - ((z[other] - z[one]) * way.conj()).real, 0) / 2 * way
    ends, step = np.concatenate([one, other]), np.concatenate([-by, by])
    move = np.bincount(ends, step.real, len(z)) + 1j * np.bincount(ends, step.imag, len(z))
    move /= np.maximum(np.bincount(ends, minlength=len(z)), 1)
    move *= np.minimum(1, MOST_OFFSET * tolerance / np.maximum(np.abs(move), 1e-12))
    moved = np.zeros(len(z), bool)
    moved[ends] = True
    off, bounds = z + move - dual_edges.middle, dual_edges.bounds
    off = np.clip(off.real, -bounds.real, bounds.real) + 1j * np.clip(off.imag, -bounds.imag, bounds.imag)
    move = np.where(moved, dual_edges.middle + off - z, 0)
    offset, at = s.offset.copy(), np.concatenate([chains.first, chains.last])
    offset[at] += move[chains.indices[at]]
    return replace(s, offset=offset, snapped=s.snapped | moved)
