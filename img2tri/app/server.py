"""The app: a page with a viewer and knobs, and the answers it asks for, on this machine only.

Starlette answers, uvicorn serves: requests are parsed, bodies arrive in pieces and slow clients are dropped by libraries that do nothing
else; the same with the standard library would be as long as this file again, and ours to keep safe. Only 127.0.0.1 is listened on. Every
request has to carry a token that is drawn anew at every start, name this address as its host, and, if it names an origin, come from this
page; anything else is refused (403), so that no other page in the browser and no other user of the machine can ask. No file is
written. Errors of the library are answered with their text (422), what is overtaken by a newer wish with nothing (204).
"""

from __future__ import annotations

import json
import secrets
import socket
import threading
from collections.abc import Awaitable, Callable, Mapping
from typing import TYPE_CHECKING, Any
from urllib.parse import parse_qs

from img2tri.app.app_page import app_page
from img2tri.app.session import OvertakenError, Session
from img2tri.errors import FileError, Img2triError, ParameterError

if TYPE_CHECKING:
    from starlette.applications import Starlette
    from starlette.requests import Request
    from starlette.responses import Response

_HOST = "127.0.0.1"
_LARGEST_BODY = 2**20  # bytes of a wish
LARGEST_IMAGE = 2**29  # bytes of a file
_SAFETY = {
    "Cache-Control": "no-store",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
}
_POLICY = (
    "default-src 'none'; connect-src 'self'; img-src data: blob:; style-src 'unsafe-inline'; script-src 'nonce-{nonce}'; "
    "base-uri 'none'; form-action 'none'"
)


def serve(session: Session, *, port: int = 0, ready: Callable[[str], None] = lambda _: None) -> None:
    """Serve the app until it is interrupted.

    Parameters
    ----------
    session
        What is asked.
    port
        To listen on; 0 takes one that is free.
    ready
        What is called with the address, once it is listened on.

    Raises
    ------
    ParameterError
        If the port is taken or not to be had.
    ModuleNotFoundError
        Without the extra ``img2tri[app]``.
    """
    import uvicorn

    listening = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    try:
        listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            listening.bind((_HOST, port))
        except (OSError, OverflowError) as problem:
            raise ParameterError(f"port: expected one that is free, found {port}: {problem}; 0 takes a free one") from problem
        listening.listen(128)
        token = secrets.token_urlsafe(24)
        number = listening.getsockname()[1]
        config = uvicorn.Config(
            Guard(answers(session, token), number, token), log_config=None, access_log=False, lifespan="off", server_header=False,
            timeout_graceful_shutdown=1, timeout_keep_alive=30,
        )  # fmt: skip
        ready(f"http://{_HOST}:{number}/?token={token}")
        threading.Thread(target=session.warm_up, daemon=True).start()
        uvicorn.Server(config).run(sockets=[listening])
    finally:
        listening.close()


class Guard:
    """Let through only what has the token, names this address as its host, and comes from this page if it says where it comes from."""

    def __init__(self, app: Callable[..., Awaitable[None]], port: int, token: str) -> None:
        self.app, self.host, self.token = app, f"{_HOST}:{port}", token

    async def __call__(self, scope: Mapping[str, Any], receive: Any, send: Any) -> None:
        """Answer a request, or refuse it."""
        if scope["type"] != "http" or not self._welcome(scope):
            if scope["type"] == "websocket":
                await send({"type": "websocket.close", "code": 1008})
            elif scope["type"] == "http":
                headers = [(b"content-type", b"text/plain; charset=utf-8"), *_encoded(_SAFETY)]
                await send({"type": "http.response.start", "status": 403, "headers": headers})
                await send({"type": "http.response.body", "body": b"refused: open the address that img2tri has printed, with its token"})
            return

        async def safely(message: dict[str, Any]) -> None:
            if message["type"] == "http.response.start":
                message["headers"] = [*message["headers"], *_encoded(_SAFETY)]
            await send(message)

        await self.app(scope, receive, safely)

    def _welcome(self, scope: Mapping[str, Any]) -> bool:
        headers: dict[str, list[str]] = {}
        for name, value in scope["headers"]:
            headers.setdefault(name.decode("latin-1").lower(), []).append(value.decode("latin-1"))
        said = headers.get("x-token") or parse_qs(scope["query_string"].decode("latin-1")).get("token", [""])
        return (
            headers.get("host") == [self.host]
            and headers.get("origin", [f"http://{self.host}"]) == [f"http://{self.host}"]
            and len(said) == 1
            and secrets.compare_digest(said[0].encode(), self.token.encode())
        )


def _encoded(headers: Mapping[str, str]) -> list[tuple[bytes, bytes]]:
    return [(name.lower().encode(), value.encode()) for name, value in headers.items()]


def answers(session: Session, token: str) -> Starlette:
    """Make what answers: the page, facts about the image, wishes, certificate, images and downloads."""
    from starlette.applications import Starlette
    from starlette.concurrency import run_in_threadpool
    from starlette.responses import HTMLResponse, JSONResponse, Response
    from starlette.routing import Route

    async def page(_: Request) -> Response:
        nonce = secrets.token_urlsafe(16)
        return HTMLResponse(app_page(token=token, nonce=nonce), headers={"Content-Security-Policy": _POLICY.format(nonce=nonce)})

    async def facts(_: Request) -> Response:
        return Response(await run_in_threadpool(session.facts), media_type="application/octet-stream")

    async def wish(request: Request) -> Response:
        wanted = await _json(request)
        options, number, window = wanted.get("options"), wanted.get("number"), wanted.get("window")
        if not isinstance(options, dict) or not isinstance(number, int) or not (window is None or _is_box(window)):
            raise ParameterError('wish: expected {"options": {...}, "number": 1} and perhaps "window": [left, bottom, right, top]')
        data = await run_in_threadpool(session.wish, options, number=number, window=window and tuple(window))
        return Response(data, media_type="application/octet-stream")

    async def certificate(_: Request) -> Response:
        return JSONResponse(await run_in_threadpool(session.certificate))

    async def image(request: Request) -> Response:
        data = await _body(request, LARGEST_IMAGE)
        await run_in_threadpool(session.load_bytes, data, request.query_params.get("name", "image"))
        return await facts(request)

    async def download(request: Request) -> Response:
        wanted = await _json(request)
        height = wanted.get("height")
        if not isinstance(height, (int, float, type(None))) or isinstance(height, bool):
            raise ParameterError(f"height: expected a number, found {height!r}")
        name, data = await run_in_threadpool(session.download, str(wanted.get("kind")), height)
        return Response(data, media_type="application/octet-stream", headers={"X-Name": name.encode("ascii", "replace").decode()})

    async def refused(_: Request, problem: Exception) -> Response:
        if isinstance(problem, OvertakenError):
            return Response(status_code=204)
        words = "expected more memory than there is" if isinstance(problem, MemoryError) else " ".join(str(problem).split())
        return JSONResponse({"error": words}, 422)

    routes = [
        Route("/", page),
        Route("/facts", facts),
        Route("/wish", wish, methods=["POST"]),
        Route("/certificate", certificate),
        Route("/image", image, methods=["POST"]),
        Route("/download", download, methods=["POST"]),
    ]
    return Starlette(routes=routes, exception_handlers={Img2triError: refused, MemoryError: refused})


async def _body(request: Request, most: int) -> bytes:
    """Read a body as it comes, no more than so many bytes of it."""
    parts, size = [], 0
    async for part in request.stream():
        size += len(part)
        if size > most:
            raise FileError(f"image: expected at most {most:,} bytes, found more; start img2tri app with its path instead")
        parts.append(part)
    return b"".join(parts)


async def _json(request: Request) -> dict[str, Any]:
    try:
        found = json.loads(await _body(request, _LARGEST_BODY))
    except (ValueError, RecursionError) as problem:
        raise ParameterError(f"request: expected JSON, found {problem}") from problem
    if not isinstance(found, dict):
        raise ParameterError(f"request: expected an object of JSON, found {type(found).__name__}")
    return found


def _is_box(window: Any) -> bool:
    return isinstance(window, list) and len(window) == 4 and all(isinstance(x, (int, float)) and not isinstance(x, bool) for x in window)
