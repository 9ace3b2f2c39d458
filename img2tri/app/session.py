"""An image and its mesh under changing options: wishes in, bytes for the viewer out. Whoever asks, a server or a notebook, asks here.

One mesh is made at a time, and the last wish wins: a mesh that is being made when a newer wish comes ends at its next stage. It is
drawn first and certified later, when the hand rests. An image is read once, not for every wish.
"""

from __future__ import annotations

import io
import threading
import time
import warnings
from collections.abc import Mapping
from typing import Any

import numpy as np

from img2tri.app import downloads, image_facts
from img2tri.app.knobs import knobs, values
from img2tri.certificate.report import certify
from img2tri.errors import Img2triError, Img2triWarning, MeshError, ParameterError
from img2tri.mesh import TriangleMesh
from img2tri.options import reproducing
from img2tri.pipeline import mesh_image
from img2tri.raster.files.byte_sources import source_of
from img2tri.raster.reading import read
from img2tri.triangles.tools.quality_summary import measure
from img2tri.types import Picture
from img2tri.views.figures.image_png import png
from img2tri.views.page import html_tables
from img2tri.views.page.html_page import pieces, thinned
from img2tri.views.page.packing import pack, packed_mesh, placed_marks

READING = ("spacing", "origin", "page")  # options that an image is read with
_SHOWN = 2048  # pixels of the picture along either side


class OvertakenError(Img2triError):
    """A newer wish has come; nobody waits for this mesh any more."""


class Session:
    """An image, the options of the last wish, and the mesh made of them.

    Parameters
    ----------
    image
        What `mesh_image` takes; None waits for `load`.
    name
        What it is called in commands and files.
    options
        Of `mesh_image`, which hold as long as no wish says otherwise.
    max_pixels
        The most an image may have.

    Attributes
    ----------
    mesh, options
        The present mesh, None before the first; and the options it was made with.
    """

    def __init__(
        self, image: Any = None, *, name: str = "image", options: Mapping[str, Any] | None = None, max_pixels: int = 2**28
    ) -> None:
        self.base = dict(options or {})
        self.options: dict[str, Any] = dict(self.base)
        self.mesh: TriangleMesh | None = None
        self.name, self.max_pixels = name, max_pixels
        self._image, self._picture, self._read_with = None, None, {}  # type: tuple[Any, Picture | None, dict[str, Any]]
        self._newest, self._one_at_a_time = 0, threading.Lock()
        if image is not None:
            self.load(image, name)

    def load(self, image: Any, name: str) -> None:
        """Take another image. If it cannot be read, the one before stays."""
        wanted = {option: self.base[option] for option in READING if option in self.base}
        picture = read(image, **wanted, max_pixels=self.max_pixels)
        with self._one_at_a_time:
            self._image, self._picture, self._read_with, self.name, self.mesh = image, picture, wanted, name, None

    def load_bytes(self, data: bytes, name: str) -> None:
        """Take another image, a file as bytes; of its name only what is behind the last slash."""
        source = source_of(io.BytesIO(data), max_pixels=self.max_pixels)
        self.load(source, name.replace("\\", "/").rpartition("/")[2][-200:] or "image")

    def warm_up(self) -> None:
        """Load what the first mesh needs, which takes longer than the mesh, while nobody waits."""
        tiny = np.pad(np.ones((6, 6), bool), 2)
        Session(tiny).wish({}, number=1)

    def facts(self) -> bytes:
        """Return what the knobs start from, the picture and its codes, packed."""
        head: dict[str, Any] = {"knobs": knobs(), "formats": list(downloads.ALL_KINDS), "solid": list(downloads.WITH_HEIGHT), "image": None}
        if self._picture is None:
            return pack(head, {})
        facts = image_facts.describe(self._picture, self.name, str(self.base.get("units") or ""))
        plain = {option: value for option, value in self.base.items() if not reproducing.is_field(value)}
        picture = png(thinned(self._picture.values, _SHOWN))
        return pack(head | {"image": facts.head, "base": plain}, {**facts.codes, "picture": image_facts.as_bytes(picture)})

    def wish(self, given: Mapping[str, Any], *, number: int, window: tuple[float, float, float, float] | None = None) -> bytes:
        """Make the mesh of some options, packed for the viewer.

        Parameters
        ----------
        given
            What the page sends, see `img2tri.app.knobs.values`.
        number
            Of the wish; a newer one, with a greater number, ends this.
        window
            (left, bottom, right, top) in world units: only what is seen, as a preview. It is not kept as the mesh.

        Raises
        ------
        OvertakenError
            If a newer wish has come.
        ParameterError, ImageError, FileError
            As `mesh_image`.
        """
        self._newest = max(self._newest, number)
        with self._one_at_a_time:
            self._still_wanted(number)
            start = time.perf_counter()
            options = self.base | values(given)
            picture = self._read(options)
            rest = {name: value for name, value in options.items() if name not in READING}
            if window is not None:
                rest["crop"] = _cut(window, picture, rest.get("crop"))
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", Img2triWarning)  # the page shows the notes, which have them
                mesh = mesh_image(picture, progress=lambda *_: self._still_wanted(number), **rest)
            if window is None:
                self.mesh, self.options = mesh, reproducing.different(options)
        metrics: dict[str, Any] = measure(mesh.vertices, mesh.triangles, ["q", "min_angle"])
        facts: dict[str, Any] = {} if mesh.origin is None else {"settings": mesh.origin.settings}
        head: dict[str, Any] = {
            "number": number,
            "preview": window is not None,
            "notes": [] if mesh.origin is None else mesh.origin.notes,
            "summary": _summary(mesh, metrics),
            "threshold": facts.get("settings", {}).get("threshold"),
            "edge_length": facts.get("settings", {}).get("edge_length"),
            "removed": (mesh.origin.counted if mesh.origin else {}).get("removed"),
            "python": reproducing.python(self.name, options),
            "command": reproducing.command(self.name, options),
            "tiles": html_tables.tiles(
                facts, len(mesh.vertices), len(mesh.triangles), len(set(mesh.regions.tolist())), metrics["q"], metrics["min_angle"]
            ),
            "seconds": time.perf_counter() - start,
        }
        about: dict[str, Any] = {"frame": picture.frame, "unit": str(options.get("units") or "")}
        about |= {"names": mesh.names, "colours": mesh.colours}
        return packed_mesh(mesh.vertices, mesh.triangles, mesh.regions, **metrics, **about, **head)

    def certificate(self) -> dict[str, Any]:
        """Return the certificate of the present mesh: pieces of HTML by their places, and the places to be looked at.

        Raises
        ------
        OvertakenError
            If a newer wish comes meanwhile.
        """
        mesh, number = self._present(), self._newest
        if mesh.origin is not None and "report" not in vars(mesh):
            # As `mesh.report` does when it is first asked for, but so that the next wish can end it.
            arrays = (mesh.vertices, mesh.triangles, mesh.regions)
            vars(mesh)["report"] = certify(*arrays, mesh.frame, mesh.origin, progress=lambda *_: self._still_wanted(number))
        facts = html_tables.from_json(mesh.report.to_json())
        metrics: dict[str, Any] = measure(mesh.vertices, mesh.triangles, ["q", "min_angle"])
        frame = mesh.frame if self._picture is None else self._picture.frame
        said = pieces(mesh.vertices, mesh.triangles, mesh.regions, **metrics, names=mesh.names, colours=mesh.colours, facts=facts)
        return {"pieces": said, "places": placed_marks(html_tables.places(facts), frame)}

    def download(self, kind: str, height: float | None = None) -> tuple[str, bytes]:
        """Return the name and the bytes of a file with the present mesh, see `img2tri.app.downloads`."""
        image = None if self._picture is None else self._picture.values
        stem = self.name.rpartition("/")[2].rpartition("\\")[2].rpartition(".")[0] or self.name
        return downloads.download(self._present(), stem, kind, height=height, image=image)

    def _still_wanted(self, number: int) -> None:
        if number < self._newest:
            raise OvertakenError("overtaken by a newer wish")

    def _present(self) -> TriangleMesh:
        if self.mesh is None:
            raise MeshError("mesh: expected one that was made, found none yet; choose an image, or mend what its knobs say")
        return self.mesh

    def _read(self, options: Mapping[str, Any]) -> Picture:
        """Return the image as read with these options, from the file only if they are others."""
        wanted = {option: options[option] for option in READING if option in options}
        if self._picture is None:
            raise ParameterError("image: expected one, found none yet")
        if wanted != self._read_with:
            self._picture, self._read_with = read(self._image, **wanted, max_pixels=self.max_pixels), wanted
        return self._picture


def _summary(mesh: TriangleMesh, metrics: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Say in numbers what two meshes are compared by."""
    return [
        ("triangles", f"{len(mesh.triangles):,}"),
        ("vertices", f"{len(mesh.vertices):,}"),
        ("smallest angle", f"{metrics['min_angle'].min():.1f}°"),
        ("mean q", f"{metrics['q'].mean():.4f}"),
        ("worst q", f"{metrics['q'].min():.3f}"),
    ]


def _cut(window: tuple[float, float, float, float], picture: Picture, crop: Any) -> tuple[float, ...]:
    """Return the part of a window that lies on the image, and in what is to be meshed of it."""
    boxes = [picture.frame.bounds, window] + ([] if crop is None else [tuple(crop)])
    low = [max(box[i] for box in boxes) for i in (0, 1)]
    high = [min(box[i] for box in boxes) for i in (2, 3)]
    if not (low[0] < high[0] and low[1] < high[1]):
        raise ParameterError("crop: expected a part of the image, found none in sight")
    return (*low, *high)
