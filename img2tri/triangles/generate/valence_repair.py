r"""Valence repair: points are added and removed, and edges flipped, where a vertex has too many or too few triangles.

In: a mesh and which of its vertices are free. Out: points to add, and which vertices stay; or triangles, some edges flipped. No smoothing
makes good triangles around an inner vertex of valence 4 (angles about 90 degrees) or 8 (about 45). Here the former are taken away and the
latter split in two; triangulated anew, this leaves vertices of valence 5, 6 and 7::

      o---o---o             o---o---o
      |\  |  /|             |  / \  |
      | \ | / |             | /   \ |
      o---8---o     ->      o-6---6-o      split across the pair of opposite neighbours
      | / | \ |             | \   / |      that best bear one more triangle each
      |/  |  \|             |  \ /  |
      o---o---o             o---o---o

What the triangulation leaves then are pairs of valences 5 and 7. Where two such pairs lie side by side, a flip makes all four 6; no
Delaunay triangulation finds it, as it is better only once its vertices have moved::

          5                     6
         / \                   /|\
        7---7       ->        6 | 6
         \ /                   \|/
          5                     6

Which vertex or edge comes first of several beside each other follows from places, never from numbers: so no mesh depends on what else
there is in the image.

Valences are made even by flips, collapses and splits since W. H. Frey and D. A. Field, Mesh relaxation: a new technique for improving
triangulations, Int. J. Numer. Methods Eng. 31, 1991, https://doi.org/10.1002/nme.1620310607.
"""

from __future__ import annotations

import numpy as np

from img2tri.arrays import Bools, Floats, Ints, Points, runs
from img2tri.triangles.min_angle_tangents import narrower

TOO_MANY = 1.5  # triangles more, or less, than there should be
FLIPS = 2  # rounds of flips; there is little left to flip then
UNEVEN = 3  # by how much the valences at the ends of an edge have to exceed those opposite it for a flip
FLAT = 20.0  # degrees: no flip makes a smaller angle, which smoothing might not open again


def excess(vertices: Points, triangles: Ints) -> Floats:
    """Return how many triangles too many each vertex (n,) has for its angle, if 60 degrees are right for one.

    This serves vertices on outlines as well: there the triangles fill less than a full turn.
    """
    a, b, c = (vertices[corner] for corner in triangles.T)
    first, second = np.angle((c - a) / (b - a)), np.angle((a - b) / (c - b))
    angles = np.stack([first, second, np.pi - first - second], axis=1)
    extra: Floats = np.bincount(triangles.ravel(), 1 - angles.ravel() / (np.pi / 3), minlength=len(vertices)).astype(np.float64)
    return extra


def repair_valences(vertices: Points, triangles: Ints, free: Bools) -> tuple[Points, Bools]:
    """Return points to add, and which vertices stay; of the free ones those go that are in no triangle, in 4 or less, in 8 or more."""
    stays = ~free
    stays[triangles] = True
    extra = excess(vertices, triangles)
    centre, neighbour, start = _neighbourhoods(vertices, triangles, free & (np.abs(extra) > TOO_MANY))
    stays[centre] = False
    crowded = extra[centre] > 0
    return _split(vertices, extra, centre, neighbour, start[crowded[start]]), stays


def flip_valences(vertices: Points, triangles: Ints, free: Bools) -> tuple[Ints, bool]:
    """Return the triangles (m, 3) after flips of edges between free vertices that make valences more even, and whether there were any.

    A flip takes a triangle from the ends of the edge and gives one to the vertices opposite it. The sum of the squares of what valences
    differ from 6 falls by it where those at the ends exceed those opposite by three.
    """
    triangles, n = triangles.copy(), len(vertices)
    valence = np.where(free, np.bincount(triangles.ravel(), minlength=n), 0)  # no edge at a fixed vertex is flipped
    for done in range(FLIPS):
        one, other = _flippable(triangles, valence)
        corners = triangles.ravel()
        a, b = (corners[_next(one, k)] for k in (1, 2))
        c, d = corners[one], corners[other]
        uneven = valence[a] + valence[b] - valence[c] - valence[d]
        first, second = np.stack([c, a, d], axis=1), np.stack([d, b, c], axis=1)
        gains = (uneven >= UNEVEN) & free[c] & free[d]
        gains[gains] = ~(narrower(vertices, first[gains], FLAT) | narrower(vertices, second[gains], FLAT))
        if not gains.any():
            return triangles, done > 0
        one, other, first, second, a, b, c, d, uneven = (each[gains] for each in (one, other, first, second, a, b, c, d, uneven))
        # Of edges that have a vertex in common the most uneven one is flipped; of these that whose new edge is shortest.
        rank = np.argsort(np.lexsort((np.abs(vertices[d] - vertices[c]), -uneven)))
        least = np.full(n, len(rank))
        for corner in (a, b, c, d):
            np.minimum.at(least, corner, rank)
        flipped = np.min([least[corner] for corner in (a, b, c, d)], axis=0) == rank
        triangles[one[flipped] // 3], triangles[other[flipped] // 3] = first[flipped], second[flipped]
        for corner, more in ((a, -1), (b, -1), (c, 1), (d, 1)):
            valence[corner[flipped]] += more
    return triangles, True


def _flippable(triangles: Ints, valence: Ints) -> tuple[Ints, Ints]:
    """Return edges whose ends have more than 12 triangles together, by the corners (k,) opposite them in their two triangles.

    A corner is counted through the rows of triangles; the edge opposite it runs from the next one to that after.
    """
    valences = valence[triangles]
    corner = (valences.sum(axis=1, keepdims=True) - valences > 12).ravel().nonzero()[0]
    a, b = (triangles.ravel()[_next(corner, k)] for k in (1, 2))
    key = np.minimum(a, b) * len(valence) + np.maximum(a, b)
    order = np.argsort(key, kind="stable")
    twice = (np.diff(key[order]) == 0).nonzero()[0]
    return corner[order[twice]], corner[order[twice + 1]]


def _next(corner: Ints, k: int) -> Ints:
    """Return the k-th corner after each, in its triangle."""
    return corner - corner % 3 + (corner + k) % 3


def _neighbourhoods(vertices: Points, triangles: Ints, chosen: Bools) -> tuple[Ints, Ints, Ints]:
    """Return the neighbours of chosen vertices, counter-clockwise: entries (centre, neighbour), and the first entry of each centre.

    Of vertices that have a neighbour in common, or are neighbours, only that with its neighbours nearest to it is kept, so that each may
    be changed without regard to others.
    """
    triangle, corner = np.nonzero(chosen[triangles])
    centre, neighbour = triangles[triangle, corner], triangles[triangle, (corner + 1) % 3]
    order = np.lexsort((np.angle(vertices[neighbour] - vertices[centre]), centre))
    centre, neighbour = centre[order], neighbour[order]
    start = np.diff(centre, prepend=-1).nonzero()[0]
    near = np.add.reduceat(np.abs(vertices[neighbour] - vertices[centre]), start) if len(start) else np.zeros(0)
    rank = np.full(len(vertices), len(vertices))
    rank[centre[start][np.argsort(near, kind="stable")]] = np.arange(len(start))
    first = np.full(len(vertices), len(vertices))
    np.minimum.at(first, neighbour, rank[centre])
    np.minimum.at(first, centre, rank[centre])
    disputed = np.zeros(len(vertices), bool)
    disputed[centre[(first[neighbour] != rank[centre]) | (first[centre] != rank[centre])]] = True
    alone = ~disputed[centre]
    centre, neighbour = centre[alone], neighbour[alone]
    return centre, neighbour, np.diff(centre, prepend=-1).nonzero()[0]


def _split(vertices: Points, extra: Floats, centre: Ints, neighbour: Ints, start: Ints) -> Points:
    """Return two points for each centre whose entries begin at `start`: halfway from it to the means of two halves of its neighbours."""
    count = np.searchsorted(centre, centre[start], side="right") - start
    of, place = runs(count)
    half = count // 2
    opposite = neighbour[start[of] + (place + half[of]) % count[of]]
    around = neighbour[start[of] + place]
    # The cheapest pair of each centre comes first in this order, of equal ones the first; then count the places from there.
    order = np.lexsort((np.round(extra[around] + extra[opposite], 6), of))
    begin = place[order][np.diff(of, prepend=-1).nonzero()[0]]
    place = (place - begin[of]) % count[of]
    points = []
    for side in (place <= half[of], (place >= half[of]) | (place == 0)):
        mean = _sums(of[side], vertices[around[side]]) / np.bincount(of[side])
        points.append((mean + vertices[centre[start]]) / 2)
    return np.concatenate(points)


def _sums(of: Ints, values: Points) -> Points:
    return np.bincount(of, values.real) + 1j * np.bincount(of, values.imag)
