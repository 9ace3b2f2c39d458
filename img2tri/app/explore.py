"""The notebook: an image -> a widget with viewer and knobs, whose `mesh` is the present one and `options` what was chosen.

The widget is one of anywidget's, so that Jupyter, VS Code, Colab and marimo show it alike. It asks what the page of the app asks, in
messages to the kernel instead of requests to a server; what it shows stands in a shadow root, away from the notebook's own style.
"""

from __future__ import annotations

import json
from functools import cache
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any, Unpack

from img2tri.app.app_page import body, scripts, style
from img2tri.app.session import OvertakenError, Session
from img2tri.errors import Img2triError, ParameterError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from img2tri.mesh import TriangleMesh
    from img2tri.options.all_options import MeshOptions


def explore(image: Any, **options: Unpack[MeshOptions]) -> Any:
    """Turn the knobs of `mesh_image` in a notebook, and watch the mesh.

    Parameters
    ----------
    image
        What `mesh_image` takes.
    **options
        Those of `mesh_image`, to begin with.

    Returns
    -------
    anywidget.AnyWidget
        To be shown as the last value of a cell. Its `mesh` is the present `TriangleMesh`, its `options` are those it was made with, as far
        as they differ from the defaults: ``mesh_image(image, **widget.options)`` makes the mesh again.

    Raises
    ------
    ParameterError
        Without the extra ``img2tri[notebook]``, or if an option is not as it must be.
    FileError, ImageError
        As `mesh_image`.
    """
    if find_spec("anywidget") is None:
        raise ParameterError("explore: expected anywidget to be installed, found it missing; pip install 'img2tri[notebook]'")
    session = Session(image, name=image if isinstance(image, str) else "image", options=options)
    session.wish({}, number=0)  # what is wrong is said here, not in the picture
    return _widget()(session)


@cache
def _widget() -> type[Any]:
    """Define the widget, when anywidget is first needed."""
    import anywidget

    class Explorer(anywidget.AnyWidget):
        """Viewer and knobs; `mesh` is the present mesh, `options` what it was made with."""

        _esm = _module()

        def __init__(self, session: Session) -> None:
            super().__init__()
            self._session = session
            self.on_msg(self._asked)

        @property
        def mesh(self) -> TriangleMesh | None:
            return self._session.mesh

        @property
        def options(self) -> dict[str, Any]:
            return dict(self._session.options)

        def _asked(self, _: Any, content: dict[str, Any], buffers: Sequence[Any]) -> None:
            """Answer a message: its number comes back, with bytes or with what is wrong."""
            said: dict[str, Any] = {"id": content.get("id")}
            try:
                name, data = _answer(self._session, str(content.get("kind")), content.get("json") or {}, content.get("name"), buffers)
                said["name"] = name
            except OvertakenError:
                data = b""
            except (Img2triError, MemoryError) as problem:
                said["error"], data = " ".join(str(problem).split()) or "expected more memory than there is", b""
            self.send(said, [data])

    return Explorer


def _answer(session: Session, kind: str, wanted: dict[str, Any], name: str | None, buffers: Sequence[Any]) -> tuple[str | None, bytes]:
    """Do what the page asks for; see `img2tri.app.server`."""
    if kind == "wish":
        return None, session.wish(wanted["options"], number=wanted["number"], window=wanted.get("window") and tuple(wanted["window"]))
    if kind == "certificate":
        return None, json.dumps(session.certificate()).encode()
    if kind == "download":
        return session.download(str(wanted.get("kind")), wanted.get("height"))
    if kind == "image":
        session.load_bytes(bytes(buffers[0]), name or "image")
    return None, session.facts()


def _module() -> str:
    """Return the script of the widget, with style and body in it."""
    texts = f"const STYLE = {json.dumps(style())}, BODY = {json.dumps(body('the kernel of this notebook makes the mesh'))};\n"
    return texts + scripts("widget.js")
