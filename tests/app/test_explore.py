from __future__ import annotations

import json
import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import numpy as np
import pytest
from app.test_session import DISC, GRAY, unpacked

import img2tri

pytest.importorskip("anywidget")


@pytest.fixture
def widget():
    """A widget, and how its page asks it: content and buffers in, those of the answer out."""
    made = img2tri.explore(GRAY, edge_length=6, names={1: "bone"})

    def ask(kind, buffers=(), **content):
        sent = []
        made.send = lambda said, data: sent.append((said, data))
        made._handle_custom_msg({"id": "a 1", "kind": kind, **content}, list(buffers))
        ((said, (data,)),) = sent
        assert said["id"] == "a 1"
        return said, data

    made.ask = ask
    return made


def test_the_mesh_is_there_at_once_and_follows_the_knobs(widget):
    assert np.array_equal(widget.mesh.vertices, img2tri.mesh_image(GRAY, edge_length=6).vertices)
    assert widget.options == {"edge_length": 6, "names": {1: "bone"}}
    widget.ask("wish", json={"options": {"edge_length": "9", "names": {"1": "bone"}}, "number": 1})
    assert widget.options == {"edge_length": 9.0, "names": {1: "bone"}}
    again = img2tri.mesh_image(GRAY, **widget.options)
    assert np.array_equal(again.vertices, widget.mesh.vertices)
    with pytest.raises(AttributeError):
        widget.mesh = None


def test_it_answers_what_the_app_answers(widget):
    assert unpacked(widget.ask("facts")[1])[0]["image"]["kind"] == "gray"
    assert "every promise kept" in json.loads(widget.ask("certificate")[1])["pieces"]["verdict"]
    said, data = widget.ask("download", json={"kind": ".off"})
    assert (said["name"], data[:3]) == ("image.off", b"OFF")
    said, data = widget.ask("wish", json={"options": {"min_angle": "50"}, "number": 9})
    assert "min_angle: expected" in said["error"]
    assert data == b""


def test_what_is_wrong_is_said_at_once():
    with pytest.raises(img2tri.ParameterError, match="min_angle"):
        img2tri.explore(DISC, min_angle=50)
    with pytest.raises(img2tri.FileError):
        img2tri.explore("missing.png")


def test_without_anywidget_it_says_what_to_install(monkeypatch):
    monkeypatch.setattr("img2tri.app.explore.find_spec", lambda _: None)
    with pytest.raises(img2tri.ParameterError, match=r"pip install 'img2tri\[notebook\]'"):
        img2tri.explore(DISC)


PAGE = b"""<!doctype html><body><div id="cell"></div><script type="module">
import widget from "/module.js";
const heard = [];
const model = {
  on: (_, f) => heard.push(f), off: () => {},
  send: async (content, _, buffers) => {
    const answer = await fetch("/ask", { method: "POST", body: JSON.stringify(content) });
    const data = await answer.arrayBuffer();
    for (const f of heard) f(JSON.parse(answer.headers.get("X-Said")), [new DataView(data)]);
  },
};
widget.render({ model, el: document.getElementById("cell") });
</script>"""


@pytest.mark.tools
def test_it_is_shown_and_turned_in_a_notebook(widget):
    from browser import browser

    class Kernel(BaseHTTPRequestHandler):
        def log_message(self, *_):
            pass

        def answer(self, data, kind, **headers):
            self.send_response(200)
            for name, value in {"Content-Type": kind, **headers}.items():
                self.send_header(name, value)
            self.end_headers()
            self.wfile.write(data)

        def do_GET(self):
            if self.path == "/module.js":
                self.answer(type(widget)._esm.encode() if isinstance(type(widget)._esm, str) else widget._esm.encode(), "text/javascript")
            else:
                self.answer(PAGE, "text/html")

        def do_POST(self):
            content = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
            said, data = widget.ask(content.pop("kind"), json=content["json"])
            self.answer(bytes(data), "application/octet-stream", **{"X-Said": json.dumps({**said, "id": content["id"]})})

    server = ThreadingHTTPServer(("127.0.0.1", 0), Kernel)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    canvas = "document.querySelector('#cell > div').shadowRoot.getElementById('canvas').dataset"
    with browser(1100, 1200) as tab:
        tab.go(f"http://127.0.0.1:{server.server_address[1]}/")
        tab.until(f"document.querySelector('#cell > div') && {canvas}.certified === {canvas}.shown && !!{canvas}.shown")
        before = tab.run(f"return {canvas}.shown")
        tab.run(
            "const e = document.querySelector('#cell > div').shadowRoot.querySelector('[data-knob=edge_length]'); e.value = '12';"
            "e.dispatchEvent(new Event('change', { bubbles: true }))"
        )
        tab.until(f"{canvas}.shown !== '{before}'")
        assert widget.options["edge_length"] == 12
        assert int(tab.run(f"return {canvas}.drawn")) == len(widget.mesh.triangles)
        assert (np.ptp(tab.shot(), axis=2) > 60).mean() > 0.02  # in colours
        assert tab.problems == []
    server.shutdown()
    server.server_close()
