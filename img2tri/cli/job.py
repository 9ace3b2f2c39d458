"""The records between the parts of the command line: what is to be done with an image, and what became of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from img2tri.raster.files.byte_sources import Source


@dataclass(frozen=True)
class Job:
    """An image, and what is to be made of it: all there is to know to do it, so that another process can.

    Attributes
    ----------
    image, source
        As typed; and its bytes, once they are read from stdin.
    options
        Of mesh_image.
    meshes
        The names of the meshes, and the options each is saved with.
    plot, colour_by, report
        The names of files, and what the figure shows.
    sent, sent_with
        The suffix of the mesh that goes to stdout, and the options it is saved with.
    quiet
        Whether nothing is to be said about it.
    summary
        Whether a row of a table is wanted.
    folder
        Where all names begin, for workers that began elsewhere.
    """

    image: str
    options: dict[str, Any]
    source: Source | None = None
    meshes: tuple[tuple[str, dict[str, Any]], ...] = ()
    plot: str | None = None
    colour_by: str | None = "quality"
    report: str | None = None
    sent: str | None = None
    sent_with: dict[str, Any] = field(default_factory=dict)
    quiet: bool = False
    summary: bool = False
    folder: str | None = None

    @property
    def files(self) -> list[str]:
        """The names of all files, in the order they are named in what is said about the job."""
        return [*(path for path, _ in self.meshes), *filter(None, (self.plot, self.report))]


@dataclass(frozen=True)
class Outcome:
    """What became of a job.

    Attributes
    ----------
    image
        As typed.
    lines
        What the mesh is, what was chosen for the user, and the files.
    warnings
        Promises that are not kept.
    problem
        Why there is no mesh; None if there is one.
    data
        The mesh for stdout.
    row
        Of a table of all images, if one is wanted.
    """

    image: str
    lines: Sequence[str] = ()
    warnings: Sequence[str] = ()
    problem: str | None = None
    data: bytes | None = None
    row: dict[str, Any] | None = None
