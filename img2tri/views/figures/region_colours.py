"""Colours for regions: a count -> that many colours, each well apart from those before it.

Hues follow the golden angle, which spreads any number of them evenly, in the OKLCH colour space, where equal steps look equal
(B. Ottosson, "A perceptual color space for image processing", 2020); lightness alternates, so that neighbours in the list also differ for
people who see hues badly. Figures, 3MF and GLB files use the same colours.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

# From OKLab to the cube roots of the cone responses, and from these to linear sRGB.
_CONES = np.array([[1.0, 0.3963377774, 0.2158037573], [1.0, -0.1055613458, -0.0638541728], [1.0, -0.0894841775, -1.2914855480]])
_LINEAR = np.array(
    [
        [4.0767416621, -3.3077115913, 0.2309699292],
        [-1.2684380046, 2.6097574011, -0.3413193965],
        [-0.0041960863, -0.7034186147, 1.7076147010],
    ]
)
_GOLDEN_ANGLE = np.pi * (3 - np.sqrt(5))
Colours = Mapping[int, Sequence[int]]  # label -> red, green and blue, 0 to 255


def region_colours(labels: Sequence[int], colours: Colours | None = None) -> list[tuple[int, int, int]]:
    """Return the colour of each region: the one that is known of it, or one of `palette`.

    Examples
    --------
    >>> region_colours([7, 9], {9: (220, 40, 40)})[1]
    (220, 40, 40)
    """
    known = colours or {}
    chosen = [known.get(label, other) for label, other in zip(labels, palette(len(labels)).tolist(), strict=True)]
    return [(int(red), int(green), int(blue)) for red, green, blue in chosen]


def as_hex(colours: Sequence[Sequence[int]]) -> list[str]:
    """Write colours as browsers do.

    Examples
    --------
    >>> as_hex(region_colours([7], {7: (220, 40, 40)}))
    ['#dc2828']
    """
    return [f"#{red:02x}{green:02x}{blue:02x}" for red, green, blue in colours]


def palette(count: int) -> NDArray[np.uint8]:
    """Return (count, 3) uint8 sRGB colours, always the same, beginning with a blue and a rose.

    Examples
    --------
    >>> palette(2).shape
    (2, 3)
    """
    i = np.arange(count)
    hue = np.deg2rad(235) + i * _GOLDEN_ANGLE
    lightness = np.array([0.68, 0.76, 0.84, 0.60, 0.52])[i % 5]  # five, as hues eight apart are alike
    lab = np.stack([lightness, 0.115 * np.cos(hue), 0.115 * np.sin(hue)], axis=1)
    linear = ((lab @ _CONES.T) ** 3 @ _LINEAR.T).clip(0, 1)
    srgb = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    return np.asarray(np.round(255 * srgb), np.uint8)
