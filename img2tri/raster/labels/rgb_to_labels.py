"""Values or colours -> a label map: an integer for each pixel, and which of them is not meshed.

An integer image is its own label map and is passed on without a copy, whatever its type. A colour is a label too: red,
green and blue in one number, written like the colours of a web page. Pictures of 16 million pixels come through in the time of
one look at each: labels are compared, never sorted.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import islice
from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.arrays import Bools
from img2tri.errors import ImageError, ParameterError, integer, shown
from img2tri.raster.in_memory.array_checks import Pixels, pixels
from img2tri.types import Picture

LISTED_LABELS = 20  # labels listed in a message
MOST_LABELS = 2**24  # in a list
EXACT_FLOATS = 2.0**53  # whole numbers up to here are exact as float64


@dataclass(frozen=True, eq=False)
class LabelMap:
    """A label for each pixel.

    Attributes
    ----------
    values
        (h, w) integers of any type that fit int64.
    background
        The value that is not meshed; None: all are.
    """

    values: NDArray[Any]
    background: int | None


def label_map(
    values: object,
    *,
    labels: bool | Iterable[int] | None = True,
    background: int | None = 0,
    missing: Bools | None = None,
    transparent: bool = False,
) -> LabelMap:
    """Turn an image into a label map.

    Parameters
    ----------
    values
        - (h, w) integers are labels themselves: segmentations, palette indices, gray values. They may have gaps and be negative.
        - (h, w) bool is 0 and 1, floats must be whole numbers.
        - (h, w, 3 or 4) integers: each colour is a label, ``0xRRGGBB`` (``0xRRRRGGGGBBBB`` for uint16). Where all colours are
          gray the label is the gray value, so a segmentation saved as RGB keeps its numbers. Alpha is ignored; what it says is said
          by `missing`.
    labels
        True or None: each value is a region. A sequence: these are, all other pixels are background.
    background
        The value that is not meshed. None: every value is meshed, 0 too, or every value in `labels`.
    missing
        (h, w) bool, pixels that are not there. They are background, or have the smallest number from 0 that is no label.
    transparent
        True: some of them are so because they are transparent, which is a background of its own: 0, a black pixel, is a label then.

    Returns
    -------
    LabelMap
        Its values are those of `values` without a copy if nothing had to change. Its `background` is the one given; with None
        and pixels left out by `labels` it is the smallest number from 0 that is not in `labels`, and these pixels have it.

    Raises
    ------
    ImageError
        If the values are not whole numbers of at most 64 bits signed, or one of `labels` does not occur.
    ParameterError
        If `labels` is empty, not integers, or contains the background; if `background` is neither an integer nor None.

    Examples
    --------
    >>> import numpy as np
    >>> grains = np.array([[0, 1], [2, 3]])
    >>> label_map(grains, labels=[1, 3]).values
    array([[0, 1], [0, 3]])
    >>> label_map(grains, labels=[0, 3], background=None)
    LabelMap(values=array([[0, 1], [1, 3]]), background=1)
    """
    numbers = _whole(pixels(values))
    background = None if background is None else label("background", background)
    if transparent and background == 0:
        background = None
    chosen = None if labels is None or labels is True else _chosen(labels, background)
    seen = numbers if missing is None else numbers[~missing]
    if chosen is not None:
        _check_found(seen, chosen)
    keep = np.ones(1, bool) if chosen is None else np.isin(numbers, chosen)
    if missing is not None:
        keep = keep & ~missing
    if keep.all():
        return LabelMap(numbers, background)
    taken = set(chosen) if chosen is not None else set(distinct(seen).tolist())
    marker = background if background is not None else next(n for n in range(len(taken) + 1) if n not in taken)
    dtype = np.result_type(numbers.dtype, np.min_scalar_type(marker))
    return LabelMap(np.where(keep, numbers, np.asarray(marker, dtype)), marker)


def distinct(labels: Pixels) -> NDArray[Any]:
    """Return the values that occur, rising.

    Labels come in runs, so the first value of each run, of which there are few, are all there is to sort.
    """
    flat = labels.reshape(-1)
    starts = np.flatnonzero(flat[1:] != flat[:-1]) + 1
    return np.unique(np.append(flat[starts], flat[0]))


def _whole(values: Pixels) -> NDArray[Any]:
    if values.ndim == 3:
        return _colours(values)
    if values.dtype == bool:
        return values.view(np.uint8)
    if values.dtype.kind == "f":
        least, greatest = float(values.min()), float(values.max())
        if not -EXACT_FLOATS <= least <= greatest <= EXACT_FLOATS:
            raise ImageError(f"labels: expected whole numbers of at most 53 bits, found floats from {least:g} to {greatest:g}")
        whole = values.astype(np.int32 if max(-least, greatest) < 2**31 else np.int64)
        if not (whole == values).all():
            found = float(values[whole != values][0])
            raise ImageError(f"labels: expected whole numbers, found {found:g}; give a threshold to mesh gray values")
        return whole
    if values.dtype == np.uint64 and values.max() > np.iinfo(np.int64).max:
        raise ImageError(f"labels: expected numbers of at most 63 bits, found {values.max()}")
    return values


def _colours(values: Pixels) -> NDArray[Any]:
    red, green, blue = values[..., 0], values[..., 1], values[..., 2]
    gray = bool((red == green).all() and (green == blue).all())
    if gray:
        numbers = _whole(red)
    else:
        bits = 16 if values.dtype == np.uint16 else 8
        if values.dtype.kind not in "iu" or values[..., :3].min() < 0 or values[..., :3].max() >= 1 << bits:
            raise ImageError(f"labels: expected colours of uint8 or uint16, found {values.dtype}; scale them to 0..255 first")
        # Three times 8 bits fit 32, three times 16 need 64.
        dtype = np.int32 if bits == 8 else np.int64
        numbers = np.left_shift(red, 2 * bits, dtype=dtype)
        numbers |= np.left_shift(green, bits, dtype=dtype)
        numbers |= blue.astype(dtype)
    return numbers


def label(name: str, value: object, expected: str = "an integer or None") -> int:
    """Return `value` as an int, or say that it cannot be a label."""
    try:
        return integer(name, value, least=-(2**63), most=2**63 - 1)
    except ParameterError:
        raise ParameterError(f"{name}: expected {expected}, found {shown(value)}") from None


def picked(labels: object, name: str = "labels") -> list[int]:
    """Return labels given as a list, set, array or iterator, rising, each once."""
    expected = "True or a list of integers" if name == "labels" else "a list of integers"
    if isinstance(labels, (str, bytes, bytearray, Mapping)) or not isinstance(labels, Iterable) or getattr(labels, "ndim", 1) != 1:
        raise ParameterError(f"{name}: expected {expected}, found {shown(labels)}")
    values = list(islice(labels, MOST_LABELS + 1))
    if not 0 < len(values) <= MOST_LABELS:
        raise ParameterError(f"{name}: expected {expected}, found {f'more than {MOST_LABELS}' if values else shown(values)}")
    return sorted({label(name, value, expected) for value in values})


def _chosen(labels: object, background: int | None) -> list[int]:
    """Return the labels picked; the background cannot be one of them."""
    chosen = picked(labels)
    if background in chosen:
        raise ParameterError(f"labels: expected values other than the background, found {background}; give background=None to mesh it too")
    return chosen


def _check_found(numbers: NDArray[Any], chosen: list[int]) -> None:
    found = distinct(numbers)
    present = set(found.tolist())
    missing = [label for label in chosen if label not in present]
    if missing:
        more = f" and {len(found) - LISTED_LABELS} more" if len(found) > LISTED_LABELS else ""
        listed = ", ".join(map(str, found[:LISTED_LABELS].tolist()))
        raise ImageError(f"labels: expected values of the image, found {missing[0]}, which is not one; there are {listed}{more}")


def label_colours(picture: Picture, labels: NDArray[Any], *, quantized: bool = False) -> dict[int, tuple[int, int, int]]:
    """Return the colour an image has for each of some labels: that of its palette, or the label itself, which is a colour.

    Parameters
    ----------
    picture, labels
        The image, and labels of it.
    quantized
        Whether labels are not the values of pixels, but the colours, or grays, these were reduced to.

    Examples
    --------
    >>> from img2tri.types import Frame
    >>> picture = Picture(np.zeros((1, 1, 3), np.uint8), Frame((1, 1)))
    >>> label_colours(picture, np.array([0xDC2828]))
    {14428200: (220, 40, 40)}
    """
    palette, known = picture.notes.get("palette"), [label for label in labels.tolist() if label >= 0]
    if palette is not None and picture.values.ndim == 2 and not quantized:
        table = np.asarray(palette)
        return {label: (int(r), int(g), int(b)) for label in known if label < len(table) for r, g, b in [table[label, :3]]}
    bits = _bits_of_colours(picture, quantized=quantized)
    if bits:
        parts = {label: tuple(label >> bits * i & (1 << bits) - 1 for i in (2, 1, 0)) for label in known}
        return {label: (r >> bits - 8, g >> bits - 8, b >> bits - 8) for label, (r, g, b) in parts.items()}
    if quantized and picture.values.dtype == np.uint8:
        return {label: (label, label, label) for label in known}
    return {}


def colour_names(picture: Picture, labels: NDArray[Any], *, quantized: bool = False) -> dict[int, str]:
    """Return a name for each label that is a colour: ``color_`` and its digits, as they are typed to pick it.

    Examples
    --------
    >>> from img2tri.types import Frame
    >>> picture = Picture(np.zeros((1, 1, 3), np.uint8), Frame((1, 1)))
    >>> colour_names(picture, np.array([0xDC2828, 0xFF]))
    {14428200: 'color_dc2828', 255: 'color_0000ff'}
    """
    digits = 3 * _bits_of_colours(picture, quantized=quantized) // 4
    return {label: f"color_{label:0{digits}x}" for label in labels.tolist() if label >= 0 and digits}


def _bits_of_colours(picture: Picture, *, quantized: bool) -> int:
    """Return the bits of red, green and blue in labels that are colours; 0 if they are none."""
    if quantized and picture.notes.get("palette") is not None:
        return 8
    values = picture.values
    return 8 * values.dtype.itemsize if values.ndim == 3 and values.dtype in (np.uint8, np.uint16) else 0
