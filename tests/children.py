"""Run hostile cases in child processes, where a crash, a hang or a full memory is an answer like any other.

`run` gives each case to a function ``"module:name"`` in a child with a limit on its memory; a child that dies or takes too long is
replaced, and the cases go on behind the one that did it.
"""

from __future__ import annotations

import contextlib
import dataclasses
import importlib
import os
import pickle
import queue
import resource
import subprocess
import sys
import tempfile
import threading
import time
from multiprocessing.forkserver import _forkserver
from pathlib import Path

GIGABYTE = 2**30
PATIENCE = 600.0  # s: what a process may take that is not to hang, on a machine busy with other work
HERE = Path(__file__).parent


@dataclasses.dataclass(frozen=True)
class Outcome:
    """What became of a case: "done" with what the function returned, "refused" with the error of img2tri, or else what it should not be.

    ``kind`` is "done", "refused", "raised", "died" or "hung"; ``text`` says more; ``seconds`` and ``peak`` (bytes, of the child so
    far) are 0 for those that did not come back.
    """

    kind: str
    text: str = ""
    seconds: float = 0.0
    peak: int = 0


@contextlib.contextmanager
def hooked_workers(folder, monkeypatch, code):
    """Let all processes that are started in the meantime run `code` first; they find it in a folder of their own."""
    (folder / "hook").mkdir()
    (folder / "hook" / "sitecustomize.py").write_text(code)
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(folder / "hook"), *filter(None, sys.path)]))
    _forkserver._stop()  # the next one hears of the hook
    yield
    _forkserver._stop()


def run(function, cases, *, seconds=10.0, memory=4 * GIGABYTE, start_up=PATIENCE):
    """Give every case to ``"module:name"`` in a child; return an `Outcome` for each."""
    outcomes: list[Outcome] = []
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "cases"
        path.write_bytes(pickle.dumps(list(cases)))
        while len(outcomes) < len(cases):
            outcomes += _one_child(function, path, len(outcomes), len(cases), seconds, memory, start_up)
    return outcomes


def _one_child(function, path, start, end, seconds, memory, start_up):
    command = [sys.executable, __file__, function, str(path), str(start), str(memory)]
    env = os.environ | {"PYTHONPATH": os.pathsep.join([str(HERE), *filter(None, sys.path)])}
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, stdin=subprocess.DEVNULL, env=env) as child:
        lines: queue.Queue[bytes] = queue.Queue()
        errors: list[bytes] = []
        # Without somebody to read it a full pipe would hold the child up.
        readers = [
            threading.Thread(target=lambda: [lines.put(line) for line in iter(child.stdout.readline, b"")] + [lines.put(b"")]),
            threading.Thread(target=lambda: errors.append(child.stderr.read())),
        ]
        for reader in readers:
            reader.start()
        outcomes: list[Outcome] = []
        lost = None
        ready, wait = False, start_up
        while start + len(outcomes) < end:
            try:
                line = lines.get(timeout=wait)
            except queue.Empty:
                lost = Outcome("hung", f"after {wait:g} s")
                break
            if line == b"ready\n":
                ready, wait = True, seconds
                continue
            if not line:
                child.wait()
                lost = Outcome("died", f"status {child.returncode}")
                break
            outcomes.append(pickle.loads(bytes.fromhex(line.decode())))
        child.kill()
        for reader in readers:
            reader.join()
    if not ready:
        raise RuntimeError(f"the child did not start: {errors}")
    if lost is not None:
        tail = errors[0].decode(errors="replace").strip()[-300:]
        outcomes.append(dataclasses.replace(lost, text=f"{lost.text}: {tail}"))
    return outcomes


def main():
    function, path, start, memory = sys.argv[1], sys.argv[2], int(sys.argv[3]), int(sys.argv[4])
    resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    module, name = function.split(":")
    work = getattr(importlib.import_module(module), name)
    from img2tri import Img2triError

    cases = pickle.loads(Path(path).read_bytes())
    # What decoders print belongs to nobody here.
    out = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    print("ready", file=out, flush=True)
    for case in cases[start:]:
        began = time.perf_counter()
        try:
            kind, text = "done", str(work(case))
        except Img2triError as error:
            kind, text = "refused", f"{type(error).__name__}: {error}"
        except BaseException as error:
            where = error.__traceback__
            while where is not None and where.tb_next is not None:
                where = where.tb_next
            place = f"{where.tb_frame.f_code.co_filename}:{where.tb_lineno}" if where else ""
            kind, text = "raised", f"{type(error).__name__}: {str(error)[:300]} at {place}"
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
        print(pickle.dumps(Outcome(kind, text, time.perf_counter() - began, peak)).hex(), file=out, flush=True)


if __name__ == "__main__":
    # So that both sides speak of the same Outcome.
    sys.path.insert(0, str(HERE))
    from children import Outcome, main

    main()
