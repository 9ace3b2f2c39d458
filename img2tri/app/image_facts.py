"""What the knobs start from: an image -> its size, kind, histogram and regions, and its pixels as codes a browser tints a mask by.

Codes are small numbers, one for each pixel: for gray values ``least + code * step``, exact wherever an image has at most 256 whole
values in a row; for labels their place in the list. A mask is then a table of 256 entries, looked up by the browser: no image
is sent while a threshold moves. Of very large images rows and columns are left out, alike in both directions.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.errors import ImageError
from img2tri.raster.labels.colours_to_gray import to_gray
from img2tri.raster.labels.label_map_detection import flat_values
from img2tri.raster.labels.otsu_threshold import binarize
from img2tri.raster.labels.rgb_to_labels import label_map
from img2tri.types import Picture
from img2tri.views.page.html_page import thinned
from img2tri.views.page.packing import placed

_MOST = 2048  # pixels along either side that are sent
_LEVELS = 256
_MANY = 4096  # labels; with more nobody looks for one in a list


@dataclass(frozen=True, eq=False)
class Facts:
    """What is known of an image.

    Attributes
    ----------
    head
        Plain data for the page.
    codes
        (h, w) codes of gray values, thinned; of labels too, where they are few enough to be listed.
    """

    head: dict[str, Any]
    codes: dict[str, NDArray[Any]]


def describe(picture: Picture, name: str, unit: str) -> Facts:
    """Describe an image.

    Examples
    --------
    >>> from img2tri.raster.reading import read
    >>> facts = describe(read(np.array([[3, 3, 9], [3, 9, 9]], np.uint8)), "a.png", "")
    >>> facts.head["kind"], facts.head["labels"], facts.head["otsu"], facts.codes["labels"].tolist()
    ('mask', [[3, 3], [9, 3]], 6.0, [[0, 0, 1], [0, 1, 1]])
    """
    values, frame = picture.values, picture.frame
    h, w = values.shape[:2]
    head: dict[str, Any] = {
        "name": name,
        "view": placed(frame, unit),
        "pixels": [w, h],
        "area": frame.spacing[0] * frame.spacing[1],
        "type": f"{values.dtype}{'' if values.ndim == 2 else f', {values.shape[2]} channels'}",
        "step": max(1, -(-max(h, w) // _MOST)),
    }
    gray, codes = _gray(picture)
    looks_like_labels = flat_values(values) is not None  # the rule by which the library refuses to choose a threshold
    if looks_like_labels and values.ndim == 3:
        values = label_map(values, background=None).values
    labels, numbers = _labels(values)
    kind = "labels" if looks_like_labels and labels else "mask" if labels and len(labels) <= 2 else "gray"
    head |= gray | {"labels": labels, "kind": kind}
    return Facts(head, codes | numbers)


def _gray(picture: Picture) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
    """Return the histogram of gray values, the level the library would choose, and the codes."""
    gray = to_gray(picture.values, palette=picture.notes.get("palette"))
    try:
        level: float | None = binarize(gray)[1].value
    except ImageError:
        level = None  # label numbers: the library asks what is meant
    values = gray.astype(np.float64) if gray.dtype == bool else gray
    least, most = float(values.min()), float(values.max())
    whole = values.dtype.kind in "iu" or gray.dtype == bool
    step = 1.0 if whole and most - least < _LEVELS else (most - least) / (_LEVELS - 1) or 1.0
    small = thinned(values, _MOST)
    codes = np.floor((small.astype(np.float64) - least) / step + 1e-9).clip(0, _LEVELS - 1).astype(np.uint8)
    counts = np.bincount(codes.ravel(), minlength=_LEVELS) * (values.size / codes.size)
    head = {"otsu": level, "least": least, "most": most, "level_step": step, "whole": whole, "counts": counts.round().astype(int).tolist()}
    return head, {"gray": codes}


def _labels(values: NDArray[Any]) -> tuple[list[list[int]] | None, dict[str, NDArray[Any]]]:
    """List the labels with their numbers of pixels, if they are whole numbers and not too many."""
    if values.ndim != 2 or values.dtype.kind not in "biu":
        return None, {}
    present, index, counts = np.unique(values, return_inverse=True, return_counts=True)
    if len(present) > _MANY:
        return None, {}
    codes = thinned(index.reshape(values.shape), _MOST).astype(np.uint8 if len(present) <= 256 else np.uint16)
    return [[int(label), int(count)] for label, count in zip(present, counts, strict=True)], {"labels": codes}


def as_bytes(data: bytes) -> NDArray[np.uint8]:
    """Return bytes as an array, to be packed."""
    return np.frombuffer(data, np.uint8)
