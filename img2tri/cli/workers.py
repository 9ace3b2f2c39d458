"""Many jobs -> their outcomes, in the order of the jobs: one after the other, or by several processes at once.

Each process is a fresh one, as the libraries behind the mesh do not bear to be forked, and has a pipe of its own, over which jobs go in
and outcomes come back. A pipe that closes tells which process has died, and so which image is to blame; a pool of the standard library
would give up all jobs then. The processes hear nothing of Ctrl-C: they are ended from here.
"""

from __future__ import annotations

import multiprocessing
import signal
import sys
import time
import traceback
from collections import deque
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import partial
from multiprocessing import resource_tracker
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess
from typing import Any

from img2tri.cli.job import Job, Outcome
from img2tri.cli.meshing_job import held, make
from img2tri.errors import ParameterError

GRACE = 2.0  # seconds for workers to tidy up


@dataclass
class _Worker:
    """A process, our end of its pipe, and the number of the job it does."""

    process: SpawnProcess
    pipe: Connection[Any, Any]
    number: int = -1


def run(jobs: Sequence[Job], workers: int, progress: Callable[[int, str, float], None]) -> Generator[Outcome]:
    """Do jobs.

    Parameters
    ----------
    jobs
        What is to be done.
    workers
        How many at once. 1 does them in this process. The outcomes are the same.
    progress
        Called with the number of a job, the name of a stage and the fraction done; what it raises ends the work.

    Yields
    ------
    Outcome
        One for each job, in their order, as soon as it and those before it are there. If a worker dies, the job it did has failed.

    Raises
    ------
    ParameterError
        If the system does not allow so many processes.
    """
    if min(workers, len(jobs)) > 1:
        yield from _at_once(jobs, workers, progress)
        return
    for number, job in enumerate(jobs):
        outcome = make(job, partial(progress, number))
        progress(number, "done", 1.0)
        yield outcome


def _at_once(jobs: Sequence[Job], workers: int, progress: Callable[[int, str, float], None]) -> Generator[Outcome]:
    """Keep so many workers busy until all is done."""
    ready = [held(job) for job in jobs]  # stdin is read here, where it is
    done = {number: job for number, job in enumerate(ready) if isinstance(job, Outcome)}
    waiting = deque((number, job) for number, job in enumerate(ready) if isinstance(job, Job))
    busy: dict[Connection[Any, Any], _Worker] = {}
    started: list[_Worker] = []
    try:
        for number in range(len(jobs)):
            while number not in done:
                while waiting and len(busy) < workers:
                    started.append(_start())
                    busy[started[-1].pipe] = started[-1]
                    _give(started[-1], *waiting.popleft())
                for pipe in wait(list(busy)):
                    worker = busy[pipe]  # type: ignore[index]
                    answer = _answer(worker, jobs)
                    if not isinstance(answer, Outcome):
                        progress(worker.number, *answer)
                        continue
                    done[worker.number] = answer
                    progress(worker.number, "done", 1.0)
                    if waiting and not worker.pipe.closed:
                        _give(worker, *waiting.popleft())
                    else:
                        del busy[worker.pipe]
            yield done.pop(number)
    finally:
        _end(started)


def _start() -> _Worker:
    context = multiprocessing.get_context("spawn")
    try:
        ours, theirs = context.Pipe()
        process = context.Process(target=_work, args=(theirs,), daemon=True)
        with _ctrl_c_held_back():
            process.start()
    except OSError as refusal:
        raise ParameterError(f"workers: expected no more than the system allows, found that it refuses another ({refusal})") from refusal
    theirs.close()
    return _Worker(process, ours)


def _give(worker: _Worker, number: int, job: Job) -> None:
    worker.number = number
    with suppress(OSError):  # a worker that has died is noticed when its answer is waited for
        worker.pipe.send(job)


def _answer(worker: _Worker, jobs: Sequence[Job]) -> Outcome | tuple[str, float]:
    """Return the outcome of the job of a worker, or how far it is."""
    image = jobs[worker.number].image
    try:
        answer: Outcome | tuple[str, float] | str = worker.pipe.recv()
    except (EOFError, OSError):
        worker.pipe.close()
        worker.process.join(GRACE)
        return Outcome(image, problem=_fate(worker.process.exitcode))
    if isinstance(answer, str):
        raise RuntimeError(f"{image}: a mistake in a worker\n{answer}")
    return answer


def _fate(status: int | None) -> str:
    how = f"ended with status {status}"
    if status is not None and status < 0:
        with suppress(ValueError):
            how = f"was ended by {signal.Signals(-status).name}"
    return f"the process that meshed it {how}; if memory ran out, fewer --workers need less"


def _end(workers: Sequence[_Worker]) -> None:
    """End all workers: those that do nothing, at once; those that write a file, when they have tidied up."""
    for worker in workers:
        worker.pipe.close()
        worker.process.terminate()
    deadline = time.monotonic() + GRACE
    for worker in workers:
        worker.process.join(max(0.0, deadline - time.monotonic()))
        worker.process.kill()
        worker.process.join()


@contextmanager
def _ctrl_c_held_back() -> Iterator[None]:
    """Start a process within, and it never hears of Ctrl-C, which a terminal sends to all; here it comes afterwards."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    resource_tracker.ensure_running()  # would let Ctrl-C through if it had yet to be started
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _work(pipe: Connection[Any, Any]) -> None:
    """Do jobs until there are no more: what a worker runs."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit())  # files that are not whole yet go
    with suppress(EOFError, OSError):  # nobody is there any more
        while True:
            job = pipe.recv()
            try:
                answer: Outcome | str = make(job, lambda stage, fraction: pipe.send((stage, fraction)))
            except Exception:
                answer = traceback.format_exc()
            pipe.send(answer)
