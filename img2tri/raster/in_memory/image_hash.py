"""The fingerprint of an image: its pixels -> one line of text that is another for any other pixels.

Files that carry it can be told to come from one and the same image, whatever that was called and wherever it lay.
"""

from __future__ import annotations

import hashlib

import numpy as np
from numpy.typing import ArrayLike


def image_hash(values: ArrayLike) -> str:
    """Return the SHA-256 of an image as 64 hexadecimal digits.

    It depends on the values, their type and the shape, not on how the machine stores numbers, nor on the layout in memory.

    Parameters
    ----------
    values
        (h, w) or (h, w, channels), as read: before any threshold.

    Examples
    --------
    >>> image_hash([[0, 1], [1, 0]])[:12] == image_hash([[0, 1], [1, 1]])[:12]
    False
    """
    array = np.asarray(values)
    little = np.ascontiguousarray(array, array.dtype.newbyteorder("<"))
    digest = hashlib.sha256(f"{little.dtype.str} {little.shape}".encode())
    # Of a mask eight pixels are a byte: on large ones the digest would take a tenth of the time of the mesh.
    digest.update((np.packbits(little) if little.dtype == bool else little.reshape(-1).view(np.uint8)).data)
    return digest.hexdigest()
