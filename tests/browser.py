"""A browser without a screen, driven through chromedriver by the W3C WebDriver protocol; nothing but the standard library is needed.

with browser() as page:
    page.go("file:///tmp/a.html")
    page.run("return document.title")
"""

from __future__ import annotations

import base64
import contextlib
import io
import json
import shutil
import subprocess
import tempfile
import time
import urllib.error
import urllib.request

import numpy as np
import pytest
from PIL import Image

PROGRAMS = ("chromium", "chromium-browser", "google-chrome")
FLAGS = [
    "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync", "--hide-scrollbars", "--force-device-scale-factor=1",
    "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1",
]  # fmt: skip
KEYS = {
    "Enter": "\ue007",
    "Tab": "\ue004",
    "Left": "\ue012",
    "Right": "\ue014",
    "Up": "\ue013",
    "Down": "\ue015",
    "Space": " ",
    "Escape": "\ue00c",
}


class Page:
    """A tab. `problems` are the errors its console has shown."""

    def __init__(self, address):
        self.address, self.session = address, ""

    def ask(self, path, body=None, method="POST"):
        data = None if method != "POST" else json.dumps(body or {}).encode()
        request = urllib.request.Request(f"{self.address}{self.session}{path}", data, {"Content-Type": "application/json"}, method=method)
        try:
            with urllib.request.urlopen(request, timeout=120) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as problem:
            raise AssertionError(json.load(problem)["value"]["message"]) from None

    def go(self, address):
        self.ask("/url", {"url": address})

    def run(self, script, *arguments):
        """What the script returns, or what the promise it returns becomes."""
        return self.ask("/execute/sync", {"script": script, "args": arguments})

    def until(self, script, seconds=20):
        end = time.monotonic() + seconds
        while not (found := self.run(f"return {script}")):
            assert time.monotonic() < end, f"waited for {script}; the console says {self.problems}"
            time.sleep(0.02)
        return found

    def element(self, css):
        """An element, found in shadow roots too if the selector says ``host >>> inner``."""
        return self.run(
            "let root = document; const parts = arguments[0].split(' >>> ');"
            "parts.forEach((part, i) => { const one = root.querySelector(part); root = i < parts.length - 1 ? one.shadowRoot : one; });"
            "return root", css
        )  # fmt: skip

    def click(self, css):
        self.ask(f"/element/{next(iter(self.element(css).values()))}/click")

    def type(self, css, text):
        self.ask(f"/element/{next(iter(self.element(css).values()))}/value", {"text": text})

    def keys(self, *names):
        actions = [{"type": kind, "value": KEYS.get(name, name)} for name in names for kind in ("keyDown", "keyUp")]
        self.ask("/actions", {"actions": [{"type": "key", "id": "keys", "actions": actions}]})

    def drag(self, places, ms=0, kind="mouse"):
        (x, y), *others = places
        moves = [{"type": "pointerMove", "x": round(a), "y": round(b), "duration": ms} for a, b in others]
        actions = [{"type": "pointerMove", "x": round(x), "y": round(y), "duration": 0}, {"type": "pointerDown", "button": 0}, *moves]
        pointer = {
            "type": "pointer",
            "id": kind,
            "parameters": {"pointerType": kind},
            "actions": [*actions, {"type": "pointerUp", "button": 0}],
        }
        self.ask("/actions", {"actions": [pointer]})

    def size(self, width, height):
        self.ask("/chromium/send_command", {"cmd": "Emulation.setDeviceMetricsOverride", "params": {
            "width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 500}})  # fmt: skip

    def shot(self, path=None):
        """What is seen, (h, w, 3)."""
        data = base64.b64decode(self.ask("/screenshot", method="GET"))
        if path is not None:
            path.write_bytes(data)
        return np.asarray(Image.open(io.BytesIO(data)).convert("RGB")).astype(int)

    @property
    def problems(self):
        return [line["message"] for line in self.ask("/se/log", {"type": "browser"}) if line["level"] == "SEVERE"]


@contextlib.contextmanager
def browser(width=1400, height=1300, *flags):
    program, driver = next(filter(None, map(shutil.which, PROGRAMS)), None), shutil.which("chromedriver")
    if program is None or driver is None:
        pytest.skip("chromium and chromedriver are not installed")
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        process = subprocess.Popen([driver, "--port=0"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        page = None
        try:
            line = next(line for line in process.stdout if "started successfully on port" in line)
            port = int(line.rstrip(". \n").rpartition(" ")[2])
            page = Page(f"http://127.0.0.1:{port}")
            options = {"binary": program, "args": [*FLAGS, f"--user-data-dir={folder}", f"--window-size={width},{height}", *flags]}
            wanted = {"alwaysMatch": {"goog:chromeOptions": options, "goog:loggingPrefs": {"browser": "ALL"}}}
            page.session = "/session/" + page.ask("/session", {"capabilities": wanted})["sessionId"]
            page.size(width, height)
            yield page
        finally:
            if page is not None and page.session:
                page.ask("", method="DELETE")
            process.terminate()
            process.wait(20)
            process.stdout.close()
