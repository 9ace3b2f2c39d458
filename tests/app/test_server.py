from __future__ import annotations

import io
import json
import re
import signal
import socket
import subprocess
import sys
import threading
import urllib.error
import urllib.request
from contextlib import contextmanager

import numpy as np
import pytest
from app.test_session import unpacked
from PIL import Image

from img2tri.cli import main

pytest.importorskip("uvicorn")
pytest.importorskip("starlette")

DISC = (np.hypot(*np.mgrid[-30:30, -30:30] + 0.5) < 22) * np.uint8(255)


@contextmanager
def served(*arguments, folder):
    """The app in a process of its own: its address and its token."""
    command = [sys.executable, "-m", "img2tri", "app", "--no-browser", *arguments]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=folder)
    try:
        line = process.stdout.readline()
        found = re.fullmatch(r"http://127\.0\.0\.1:(\d+)/\?token=([\w-]{20,})\n", line)
        assert found, line + process.stderr.read()
        yield f"http://127.0.0.1:{found[1]}", found[2]
    finally:
        process.send_signal(signal.SIGINT)
        try:
            process.wait(20)
        except subprocess.TimeoutExpired:
            process.kill()
        said = process.stderr.read()
        for pipe in (process.stdout, process.stderr):
            pipe.close()
    assert process.returncode == 0, said
    assert said == ""


@pytest.fixture(scope="module")
def app(tmp_path_factory):
    folder = tmp_path_factory.mktemp("app")
    Image.fromarray(DISC).save(folder / "disc.png")
    with served("disc.png", folder=folder) as (address, token):
        yield address, token
    assert [path.name for path in folder.iterdir()] == ["disc.png"]  # no file was written


def ask(address, path, token=None, data=None, **headers):
    """Status, headers and body of an answer."""
    sent = {name.replace("_", "-"): value for name, value in headers.items()} | ({"X-Token": token} if token else {})
    body = json.dumps(data).encode() if isinstance(data, dict) else data
    try:
        with urllib.request.urlopen(urllib.request.Request(address + path, body, sent), timeout=60) as answer:
            return answer.status, dict(answer.headers), answer.read()
    except urllib.error.HTTPError as problem:
        with problem:
            return problem.code, dict(problem.headers), problem.read()


@pytest.mark.parametrize("path", ["/", "/facts", "/wish", "/certificate", "/nothing", "/?token=", "/?token=wrong", "/facts?token=wrong"])
def test_without_the_token_nothing_is_answered(app, path):
    address, token = app
    status, _, body = ask(address, path)
    assert status == 403
    assert token.encode() not in body
    assert ask(address, path.partition("?")[0], token[:-1])[0] == 403
    assert ask(address, path.partition("?")[0] + f"?token={token}&token={token}x")[0] == 403


@pytest.mark.parametrize("headers", [{"Host": "evil.example"}, {"Host": "localhost"}, {"Origin": "http://evil.org"}, {"Origin": "null"}])
def test_another_host_or_origin_is_refused(app, headers):
    address, token = app
    assert ask(address, f"/?token={token}", **headers)[0] == 403
    assert ask(address, "/wish", token, {"options": {}, "number": 1}, **headers)[0] == 403
    assert ask(address, f"/?token={token}", Origin=address)[0] == 200


def test_the_page_asks_nobody_else(app):
    address, token = app
    status, headers, body = ask(address, f"/?token={token}")
    assert status == 200
    policy = headers["content-security-policy"]
    nonce = re.search(r"script-src 'nonce-([\w-]+)'", policy)[1]
    assert "default-src 'none'; connect-src 'self'" in policy
    assert headers["referrer-policy"] == "no-referrer"
    assert headers["cache-control"] == "no-store"
    assert f'<script nonce="{nonce}">'.encode() in body
    assert not re.findall(rb"https?://(?!www\.w3\.org)", body)
    assert not re.findall(rb"@\w+@", body)


def test_it_listens_on_this_machine_only(app):
    port = int(app[0].rpartition(":")[2])
    with socket.socket() as other:
        other.settimeout(2)
        name = socket.gethostbyname(socket.gethostname())
        if not name.startswith("127."):
            assert other.connect_ex((name, port)) != 0


def test_wishes_certificate_and_downloads(app):
    address, token = app
    status, _, body = ask(address, "/wish", token, {"options": {"edge_length": "6"}, "number": 1})
    assert status == 200
    head, _ = unpacked(body)
    assert head["command"] == "img2tri mesh disc.png -o mesh.vtu --edge-length 6"
    assert "every promise kept" in json.loads(ask(address, "/certificate", token)[2])["pieces"]["verdict"]
    status, headers, body = ask(address, "/download", token, {"kind": ".off", "height": 3})
    assert (status, headers["x-name"], body[:3]) == (200, "disc.off", b"OFF")


@pytest.mark.parametrize(
    ("data", "words"),
    [
        ({"options": {"min_angle": "50"}, "number": 2}, "min_angle: expected"),
        ({"options": {"max_pixels": 4}, "number": 2}, "max_pixels: expected an option"),
        ({"options": [], "number": 2}, "wish: expected"),
        ({"options": {}, "number": "x"}, "wish: expected"),
        ({"options": {}, "number": 2, "window": [1, 2]}, "wish: expected"),
        ({"options": {"edge_length": {"one": 2}}, "number": 2}, "edge_length: expected whole numbers"),
        ({"options": {"crop": [1]}, "number": 2}, "crop: expected"),
        (b"{", "request: expected JSON"),
        (b"[" * 100_000, "request: expected JSON"),
        (b"[]", "request: expected an object"),
        (b" " * 2**21, "expected at most"),
    ],
)
def test_errors_appear_as_they_are(app, data, words):
    address, token = app
    status, _, body = ask(address, "/wish", token, data)
    assert status == 422
    assert words in json.loads(body)["error"]


def test_images_are_taken_and_what_is_none_is_refused(app):
    address, token = app
    file = io.BytesIO()
    Image.fromarray(np.kron(np.arange(4, dtype=np.uint8).reshape(2, 2), np.ones((20, 20), np.uint8))).save(file, "PNG")
    status, _, body = ask(address, "/image?name=..%2F..%2Fetc%2Fgrains.png", token, file.getvalue())
    assert status == 200
    facts = unpacked(body)[0]["image"]
    assert (facts["name"], facts["kind"], len(facts["labels"])) == ("grains.png", "labels", 4)
    status, _, body = ask(address, "/image?name=a.png", token, b"no image")
    assert status == 422
    assert unpacked(ask(address, "/facts", token)[2])[0]["image"]["name"] == "grains.png"
    assert ask(address, "/wish", token, {"options": {"labels": True, "background": None}, "number": 3})[0] == 200


def test_many_at_once_get_an_answer_each(app):
    address, token = app
    found = []

    def wish(number):
        found.append(ask(address, "/wish", token, {"options": {"labels": True, "seed": number}, "number": number})[0])

    threads = [threading.Thread(target=wish, args=(number,)) for number in range(100, 108)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert set(found) <= {200, 204}
    assert 200 in found


def test_it_begins_without_an_image_and_says_what_is_wrong(tmp_path, capsys):
    with served(folder=tmp_path) as (address, token):
        assert unpacked(ask(address, "/facts", token)[2])[0]["image"] is None
        assert "image: expected one" in json.loads(ask(address, "/wish", token, {"options": {}, "number": 1})[2])["error"]
        port = address.rpartition(":")[2]
        assert main(["app", "--no-browser", "--port", port]) == 2
        assert "port: expected one that is free" in capsys.readouterr().err
    (tmp_path / "a.png").write_bytes(b"none")
    wrong = {"missing.png": "no such file", "--port=70000": "--port: expected 0 to 65535", str(tmp_path / "a.png"): "a.png"}
    for argument, words in wrong.items():
        assert main(["app", "--no-browser", argument]) == 2
        assert words in capsys.readouterr().err
