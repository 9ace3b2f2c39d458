"""Names of arrays as files can hold them: what would be lost, renamed, or would spoil the file is refused.

VTK writes quotes, angle brackets and ampersands as they are, into XML; HDF5 takes slashes for groups, and VTK's writer of it dots for the
same; names in MSH stand in quotes; those in PLY hold no space.
"""

from __future__ import annotations

import re
from collections.abc import Iterable

from img2tri.errors import ParameterError

_PLAIN = re.compile(r"[^\x00-\x1f\"'<>&/\\]+")


def check_array_names(names: Iterable[str], suffix: str) -> None:
    """Refuse names of arrays that a format does not hold as they are.

    Examples
    --------
    >>> check_array_names(["T", "flow (m/s)"], ".vtu")
    Traceback (most recent call last):
    ...
    img2tri.errors.ParameterError: data: expected names without quotes, slashes, <, >, & and line breaks, found 'flow (m/s)'
    """
    for name in names:
        if not _PLAIN.fullmatch(name) or name != name.strip():
            raise ParameterError(f"data: expected names without quotes, slashes, <, >, & and line breaks, found {name!r}")
        if suffix == ".vtkhdf" and "." in name:
            raise ParameterError(f"data: expected names without dots for .vtkhdf, found {name!r}")
