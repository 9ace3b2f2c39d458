"""The alpha channel of a picture -> which pixels are there.

Where alpha is 0 somewhere it says what is there: transparent pixels are no colour, not even black, and are not meshed. A pixel is there if
it is at least half as opaque as the most opaque one, which on the anti-aliased edge of a drawing is where the drawing covers most of it.
Where nothing is fully transparent, alpha only dims what is seen.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.arrays import Bools
from img2tri.raster.in_memory.array_checks import Pixels
from img2tri.types import Picture


def alpha_channel(picture: Picture) -> NDArray[Any] | None:
    """Return the alpha (h, w) of a picture, of its colours or of its palette; None if it has none."""
    palette = picture.notes.get("palette")
    if palette is not None:
        return np.asarray(palette[:, 3][picture.values]) if palette.shape[1] == 4 else None
    return np.asarray(picture.values[..., 3]) if picture.values.shape[2:] == (4,) else None


def says_what_is_there(alpha: NDArray[Any] | None) -> bool:
    """Tell whether an alpha channel is 0 somewhere, and not everywhere."""
    return alpha is not None and bool(alpha.min() == 0) and bool(alpha.max() > 0)


def half_opaque(alpha: NDArray[Any]) -> float:
    """Return the alpha from which on a pixel is there."""
    return float(alpha.max()) / 2


def transparent(alpha: NDArray[Any] | None) -> Bools | None:
    """Return the mask of the pixels that are not there; None if alpha does not say.

    Examples
    --------
    >>> transparent(np.array([[0, 100, 255]]))
    array([[ True,  True, False]])
    """
    return alpha < half_opaque(alpha) if alpha is not None and says_what_is_there(alpha) else None


def without_hidden(values: Pixels, missing: Bools | None) -> Pixels:
    """Return values with those of a pixel that is there where there is none, so that no value comes in that cannot be seen."""
    if missing is None or missing.all():
        return values
    copy = values.copy()
    copy[missing] = values[np.unravel_index(int(np.argmin(missing)), missing.shape)]
    return copy
