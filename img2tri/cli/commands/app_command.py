"""``img2tri app``: its arguments, and the server while it runs."""

from __future__ import annotations

import os
from argparse import Namespace, RawDescriptionHelpFormatter
from contextlib import suppress
from importlib.util import find_spec
from typing import Any

from img2tri.cli.printing import tell
from img2tri.errors import FileError, ParameterError
from img2tri.options.parsing import whole_number

ABOUT = """Open a page in the browser: choose an image, turn the knobs, and watch the mesh.

It listens on this machine only, and prints its address, which holds a token
that is new at every start; without it nothing is answered. No file is written:
what is saved, the browser downloads. Ctrl-C ends it. Needs img2tri[app].
"""


def add_app(commands: Any) -> None:
    """Add the command to those of the parser."""
    app = commands.add_parser(
        "app",
        help="a page to turn the knobs and watch the mesh",
        usage="img2tri app [IMAGE] [--port N] [--no-browser]",
        description=ABOUT,
        formatter_class=RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    app.add_argument("image", nargs="?", metavar="IMAGE", help="to begin with; others can be dropped on the page")
    app.add_argument("--port", type=whole_number, default=0, metavar="N", help="to listen on (default: one that is free)")
    app.add_argument("--no-browser", action="store_true", help="print the address only")


def run_app(arguments: Namespace) -> int:
    """Run ``img2tri app`` until it is interrupted; 0 is its exit status then."""
    for needed in ("starlette", "uvicorn"):
        if find_spec(needed) is None:
            raise ParameterError(f"app: expected {needed} to be installed, found it missing; pip install 'img2tri[app]'")
    from img2tri.app.server import serve
    from img2tri.app.session import Session

    if not 0 <= arguments.port <= 65535:
        raise ParameterError(f"--port: expected 0 to 65535, found {arguments.port}")
    if arguments.image is not None and not os.path.isfile(arguments.image):
        raise FileError(f"{arguments.image}: expected an image, found no such file")

    def ready(address: str) -> None:
        tell([address])
        if not arguments.no_browser:
            import webbrowser

            webbrowser.open(address)

    with suppress(KeyboardInterrupt):  # how it is meant to end
        serve(Session(arguments.image, name=arguments.image or "image"), port=arguments.port, ready=ready)
    return 0
