"""SciPy's compiled kernels, without the packages around them: to import `scipy.linalg` or `scipy.sparse` takes longer than a small mesh.

In: where SciPy has an extension module. Out: that module. These packages import a good part of NumPy and of each other, 0.3 s in all, for
the sake of what is not used here; the extension modules need none of it.
"""

from __future__ import annotations

import sys
from functools import cache
from importlib import import_module
from importlib.machinery import PathFinder
from importlib.util import module_from_spec
from typing import Any


@cache
def scipy_kernel(package: str, name: str) -> Any:
    """Return an extension module of SciPy: the one that is imported already, or else one loaded from its file, apart from its package.

    Raises
    ------
    ImportError
        SciPy has no such module; these are its own, and may move.

    Examples
    --------
    >>> scipy_kernel("linalg", "_flapack").dpbtrf
    <fortran ...>
    """
    import scipy  # its start makes shared libraries known on Windows

    known = sys.modules.get(f"scipy.{package}.{name}")
    if known is not None:
        return known
    spec = PathFinder.find_spec(f"{__name__}.{name}", [f"{folder}/{package}" for folder in scipy.__path__])
    if spec is None or spec.loader is None:  # as in programs packed into one file
        return import_module(f"scipy.{package}.{name}")
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
