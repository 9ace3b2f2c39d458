"""The page of the app, and the same for a notebook: the viewer of `img2tri.views.page`, with the knobs beside it."""

from __future__ import annotations

import json
from functools import cache
from importlib.resources import files

from img2tri import __version__
from img2tri.views.page.html_page import BLANK, SCRIPTS, filled, resource


@cache
def own(name: str) -> str:
    """Return a text that lies beside this file."""
    return files("img2tri.app").joinpath(name).read_text(encoding="utf-8")


def app_page(*, token: str, nonce: str) -> str:
    """Return the page of the app; scripts run by the nonce, and ask with the token."""
    parts = {
        "version": __version__,
        "title": "img2tri",
        "policy": '<link rel="icon" href="data:,">',  # or the browser asks for one
        "kind": "img2tri app",
        "style": style(),
        "body": body("nothing leaves this machine"),
        "data": f'<script type="application/json" id="token">{json.dumps(token)}</script>',
        "nonce": f' nonce="{nonce}"',
        "script": scripts("fetching.js"),
    }
    return filled(resource("page.html"), parts)


def style() -> str:
    """Return the style sheet of viewer and knobs."""
    return resource("page.css") + own("knobs.css")


def body(foot: str) -> str:
    """Return viewer and knobs as HTML, yet without an image."""
    parts = {"title": "img2tri", "knobs": own("knobs.html"), "python": own("python.html"), "foot": foot}
    return filled(resource("body.html"), BLANK | parts)


def scripts(last: str) -> str:
    """Return the scripts, the last of which asks and begins."""
    return "".join([*map(resource, SCRIPTS), own("knob_panel.js"), own("knobs.js"), own(last)])
