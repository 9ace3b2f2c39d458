"""A ``PIL.Image.Image`` is recognised here, without importing Pillow; `files.pillow_images.of_pillow` takes its values."""

from __future__ import annotations

from typing import Any


def is_pillow(image: Any) -> bool:
    """Tell whether `image` is a ``PIL.Image.Image``."""
    return all(hasattr(type(image), name) for name in ("getpalette", "getbands", "tobytes", "convert"))
