"""A picture and the colours wanted of it -> a label map, and the mixes that place the edges between colours.

A colour's label is the one `rgb_to_labels` would give it: ``0xRRGGBB``, or the gray value of a gray image. Gray values that are no whole
numbers are numbered from 0, the darkest.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.arrays import Bools, Floats, Ints
from img2tri.errors import ImageError, ParameterError
from img2tri.raster.labels.flat_colours import assigned, find_colours, value_range
from img2tri.raster.labels.rgb_to_labels import LabelMap
from img2tri.types import ColourMix


def label_by_colours(
    values: NDArray[Any], colours: int | Sequence[float], *, background: int | None, missing: Bools | None = None
) -> tuple[LabelMap, ColourMix]:
    """Give each pixel the label of one of a few colours.

    Parameters
    ----------
    values
        (h, w) gray values, or (h, w, 3 or 4) colours, of which alpha is ignored.
    colours
        How many there are besides the background, or their labels. The background is always one of them, if the image has it.
    background
        The label that is not meshed; None: there is none.
    missing
        (h, w) pixels that are not there: they are background, or have a label of their own.

    Returns
    -------
    labels
        The label map.
    mix
        What places the outlines.

    Raises
    ------
    ImageError
        If colours are no integers of 8 or 16 bit.
    ParameterError
        If there are not so many colours, or one cannot be in such an image.

    Examples
    --------
    >>> smooth = np.array([[0, 0, 90, 200, 200], [0, 0, 90, 200, 200]], np.uint8)
    >>> label_by_colours(smooth, [200], background=0)[0].values[0]
    array([  0,   0,   0, 200, 200])
    """
    channels = _channels(values)
    bits = 16 if channels.dtype == np.uint16 else 8
    ground = None if background is None else unpacked(background, channels, bits)
    if isinstance(colours, int):
        found = find_colours(channels, colours, ground, missing)
    else:
        found = np.array([unpacked(colour, channels, bits) for colour in colours])
        if ground is not None and not (found == ground).all(axis=1).any():
            found = np.vstack([found, ground])
    numbers = _labels_of(found, channels, bits)
    if ground is not None and background is not None:
        numbers[(found == ground).all(axis=1)] = background
    index, _ = assigned(channels, found)
    labels = numbers[index]
    marker = next(n for n in range(len(numbers) + 1) if n not in numbers) if background is None else background
    labels = labels if missing is None else np.where(missing, marker, labels)
    order = np.argsort(numbers)
    unmeshed = background if missing is None else marker
    return LabelMap(labels, unmeshed), ColourMix(channels, numbers[order], found[order], marker, missing)


def _channels(values: NDArray[Any]) -> NDArray[Any]:
    """Return (h, w, 1 or 3): one channel where all colours are gray."""
    if values.ndim == 2:
        return (values.view(np.uint8) if values.dtype == bool else values)[..., None]
    colours = values[..., :3]
    if (colours == colours[..., :1]).all():
        return colours[..., :1]
    if values.dtype.kind == "f" or values.dtype.itemsize > 2:
        raise ImageError(f"colors: expected colours of uint8 or uint16, found {values.dtype}; scale them to 0..255 first")
    return colours


def unpacked(label: float, channels: NDArray[Any], bits: int) -> Floats:
    """Return the colour (c,) a label stands for."""
    if channels.shape[2] == 1:
        gray = int(label) >> 16 if float(label).is_integer() and label > value_range(channels) and _is_gray(int(label)) else label
        if channels.dtype in (np.uint8, np.uint16) and not 0 <= gray <= value_range(channels):
            raise ParameterError(f"colors: expected values of a gray image of {channels.dtype}, found {label}")
        return np.array([float(gray)])
    if not (float(label).is_integer() and 0 <= label < 1 << 3 * bits):
        raise ParameterError(f"colors: expected colours like 0xdc2828, found {label}")
    return np.array([(int(label) >> shift) & ((1 << bits) - 1) for shift in (2 * bits, bits, 0)], np.float64)


def _is_gray(label: int) -> bool:
    return label >> 16 == (label >> 8) & 255 == label & 255


def _labels_of(colours: Floats, channels: NDArray[Any], bits: int) -> Ints:
    whole = np.rint(colours).astype(np.int64)
    if channels.shape[2] == 3:
        return np.asarray((whole[:, 0] << 2 * bits) | (whole[:, 1] << bits) | whole[:, 2])
    if (whole == colours).all() and len(np.unique(whole)) == len(whole):
        return np.asarray(whole[:, 0])
    return np.asarray(colours[:, 0].argsort().argsort())
