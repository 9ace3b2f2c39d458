"""Where functions are called: in this process, or in processes of this machine; `dask_cluster` has the third place.

The processes are those of `concurrent.futures`. The libraries behind a mesh do not bear to be forked while they work, so that none is
forked from this process, but from one that has loaded them once and does nothing (a fork server; where there is none they are started
afresh). It stays for the next time, with the environment it was started in. They hear nothing of Ctrl-C, which a terminal sends to all:
they are ended from here, and tidy up files that are not whole. When one dies the pool is broken with all it was given; `in_order` calls
those again, the first of them alone, which tells whose fault it was.
"""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import partial
from typing import TYPE_CHECKING, Any, Protocol

from img2tri.errors import ParameterError, integer

if TYPE_CHECKING:
    from concurrent.futures import Future, ProcessPoolExecutor

GRACE = 2.0  # seconds for processes to tidy up
MOST_WORKERS = 10_000
AHEAD = 2  # batches for each worker, so that none waits for the next
MOST_IN_A_BATCH = 64


class WorkerLostError(Exception):
    """The process that ran a function is gone, with what it was given."""


class Workers(Protocol):
    """Where functions are called: how many batches may be under way, and how large they may get."""

    window: int
    most_in_a_batch: int

    def submit(self, function: Callable[..., Any], *given: Any) -> Any:
        """Have a function called; return what `result` waits for."""

    def result(self, call: Any) -> Any:
        """Wait for a result; raise what the function raised, or `WorkerLostError`."""

    def holds(self, call: Any, /) -> bool:
        """Whether a call is still under way, or done, after another lost its worker."""

    def close(self, *, at_once: bool) -> None:
        """End the work: when all is done, or at once."""


def local_workers(count: int | None) -> Workers:
    """Return so many local processes; None: as many as there are cores; 1 is this process itself."""
    number = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    number = number if count is None else integer("workers", count, least=1, most=MOST_WORKERS)
    return Here() if number == 1 else Processes(number)


class Here:
    """The process itself: a function is called when its result is wanted."""

    window = most_in_a_batch = 1

    def submit(self, function: Callable[..., Any], *given: Any) -> Callable[[], Any]:
        """Keep the call for later."""
        return partial(function, *given)

    def result(self, call: Callable[[], Any]) -> Any:
        """Call."""
        return call()

    def holds(self, _call: Callable[[], Any], /) -> bool:
        """Keep all calls."""
        return True

    def close(self, *, at_once: bool) -> None:
        """End nothing."""


class Processes:
    """Processes of this machine."""

    def __init__(self, count: int) -> None:
        self.count, self.window, self.most_in_a_batch = count, AHEAD * count, MOST_IN_A_BATCH
        self.pool: ProcessPoolExecutor | None = None

    def submit(self, function: Callable[..., Any], *given: Any) -> Future[Any]:
        """Have a function called; a pool that is broken is replaced."""
        from concurrent.futures.process import BrokenProcessPool

        try:
            with _ctrl_c_held_back():
                return self._started().submit(_called, function, *given)
        except BrokenProcessPool:
            self.close(at_once=True)
            with _ctrl_c_held_back():
                return self._started().submit(_called, function, *given)
        except OSError as refusal:
            raise ParameterError(
                f"workers: expected no more than the system allows, found that it refuses another ({refusal})"
            ) from refusal

    def result(self, call: Future[Any]) -> Any:
        """Wait for a result."""
        from concurrent.futures.process import BrokenProcessPool

        try:
            return call.result()
        except BrokenProcessPool as broken:
            self.close(at_once=True)
            raise WorkerLostError from broken

    def holds(self, call: Future[Any], /) -> bool:
        """Keep the calls that came to an end before the pool broke."""
        from concurrent.futures.process import BrokenProcessPool

        return call.done() and not call.cancelled() and not isinstance(call.exception(), BrokenProcessPool)

    def close(self, *, at_once: bool) -> None:
        """End all processes: at once those that do nothing, those that write a file when they have tidied up."""
        pool, self.pool = self.pool, None
        if pool is None:
            return
        processes = list((getattr(pool, "_processes", None) or {}).values())
        pool.shutdown(wait=not at_once, cancel_futures=True)
        if at_once:
            for process in processes:
                process.terminate()
            for process in processes:
                process.join(GRACE)
                process.kill()
                process.join()

    def _started(self) -> ProcessPoolExecutor:
        if self.pool is None:
            from concurrent.futures import ProcessPoolExecutor

            self.pool = ProcessPoolExecutor(self.count, _context(), initializer=_prepare)
        return self.pool


def _context() -> Any:
    """Return how processes are started."""
    import multiprocessing

    if "forkserver" not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["img2tri.many.preloaded"])
    return context


def _called(function: Callable[..., Any], *given: Any) -> Any:
    try:
        return function(*given)
    except SystemExit:  # asked to end, files are tidied up: the pool would go on with the next call
        os._exit(1)


def _prepare() -> None:
    """Set signals in a new process."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))


@contextmanager
def _ctrl_c_held_back() -> Iterator[None]:
    """Start a process within, and it never hears of Ctrl-C; here it comes afterwards."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    from multiprocessing import resource_tracker

    resource_tracker.ensure_running()  # would let Ctrl-C through if it had yet to be started
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        with suppress(ValueError):
            signal.pthread_sigmask(signal.SIG_SETMASK, before)
