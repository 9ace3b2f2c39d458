r"""Adding and removing points where a vertex has too many or too few triangles.

No smoothing makes good triangles around an inner vertex that has 4 of them (angles about 90 degrees) or 8 (about 45). Here the
former are taken away and the latter split in two; triangulated anew, this leaves vertices of 5, 6 and 7 triangles::

      o---o---o             o---o---o
      |\  |  /|             |  / \  |
      | \ | / |             | /   \ |
      o---8---o     ->      o-6---6-o      split across the pair of opposite neighbours
      | / | \ |             | \   / |      that best bear one more triangle each
      |/  |  \|             |  \ /  |
      o---o---o             o---o---o
"""

from __future__ import annotations

import numpy as np

from img2tri.triangles.generate.hexagonal_lattice import Complex
from img2tri.types import Bools, Floats, Ints

TOO_MANY = 1.5  # triangles more, or less, than there should be


def surplus(vertices: Complex, triangles: Ints) -> Floats:
    """Return how many triangles too many each vertex has for its angle, if 60 degrees are right for one.

    This serves vertices on outlines as well: there the triangles fill less than a full turn.
    """
    a, b, c = (vertices[corner] for corner in triangles.T)
    first, second = np.angle((c - a) / (b - a)), np.angle((a - b) / (c - b))
    angles = np.stack([first, second, np.pi - first - second], axis=1)
    extra: Floats = np.bincount(triangles.ravel(), 1 - angles.ravel() / (np.pi / 3), minlength=len(vertices)).astype(np.float64)
    return extra


def repaired(vertices: Complex, triangles: Ints, free: Bools) -> tuple[Complex, Bools]:
    """Return points to add, and which vertices stay; of the free ones those go that are in no triangle, in 4 or less, in 8 or more."""
    stays = ~free
    stays[triangles] = True
    extra = surplus(vertices, triangles)
    centre, ring, start = _rings(vertices, triangles, free & (np.abs(extra) > TOO_MANY))
    stays[centre] = False
    crowded = extra[centre] > 0
    start = start[crowded[start]]  # the rings to split, by their first entries
    return _split(vertices, extra, centre, ring, start), stays


def _rings(vertices: Complex, triangles: Ints, chosen: Bools) -> tuple[Ints, Ints, Ints]:
    """Return the neighbours of chosen vertices, counter-clockwise: entries (centre, neighbour), and the first entry of each centre.

    Of vertices whose rings have a vertex in common only that of lowest number is kept, so that each may be changed without regard to
    others.
    """
    triangle, corner = np.nonzero(chosen[triangles])
    centre, ring = triangles[triangle, corner], triangles[triangle, (corner + 1) % 3]
    order = np.lexsort((np.angle(vertices[ring] - vertices[centre]), centre))
    centre, ring = centre[order], ring[order]
    owner = np.full(len(vertices), len(vertices))
    np.minimum.at(owner, ring, centre)
    np.minimum.at(owner, centre, centre)
    disputed = np.zeros(len(vertices), bool)
    disputed[centre[(owner[ring] != centre) | (owner[centre] != centre)]] = True
    alone = ~disputed[centre]
    centre, ring = centre[alone], ring[alone]
    return centre, ring, np.flatnonzero(np.diff(centre, prepend=-1))


def _split(vertices: Complex, extra: Floats, centre: Ints, ring: Ints, start: Ints) -> Complex:
    """Return two points for each ring that begins at `start`: halfway from the centre to the means of the two halves of the ring."""
    count = np.searchsorted(centre, centre[start], side="right") - start
    of = np.repeat(np.arange(len(start)), count)
    place = np.arange(len(of)) - np.repeat(np.cumsum(count) - count, count)
    half = count // 2
    opposite = ring[start[of] + (place + half[of]) % count[of]]
    neighbour = ring[start[of] + place]
    # The cheapest pair of each ring comes first in this order; then count the places from there.
    order = np.lexsort((extra[neighbour] + extra[opposite], of))
    begin = place[order][np.flatnonzero(np.diff(of, prepend=-1))]
    place = (place - begin[of]) % count[of]
    points = []
    for side in (place <= half[of], (place >= half[of]) | (place == 0)):
        mean = _sums(of[side], vertices[neighbour[side]]) / np.bincount(of[side])
        points.append((mean + vertices[centre[start]]) / 2)
    return np.concatenate(points)


def _sums(of: Ints, values: Complex) -> Complex:
    return np.bincount(of, values.real) + 1j * np.bincount(of, values.imag)
