"""Files of an unfinished mesh in tiles: whole or not there, and what is done stays when one cannot be written."""

from __future__ import annotations

from pathlib import Path

from img2tri.views.formats.atomic_write import store


def write(path: Path, data: bytes) -> None:
    """Write a file from which an interrupted run can go on."""
    store(path, data, advice="; what is done stays, run it again then")
