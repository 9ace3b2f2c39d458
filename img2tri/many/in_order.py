"""Calls -> results, in order: so many at once, in batches that are worth their cost, and once more where a worker was lost.

What is given is taken lazily, only as far ahead as workers need to be kept busy, so memory holds what is in flight.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Generator, Iterable
from itertools import islice
from typing import Any, TypeVar

from img2tri.many.local_workers import WorkerLostError, Workers

Thing = TypeVar("Thing")
Answer = TypeVar("Answer")

WORTH = 0.25  # seconds of work a batch should have: a call costs a cluster some milliseconds


def in_order(
    function: Callable[[Thing], Answer],
    things: Iterable[Thing],
    workers: Workers,
    *,
    lost: Callable[[Thing], Answer],
    progress: Callable[[int], Any] | None = None,
) -> Generator[Answer]:
    """Call a function of each thing.

    Parameters
    ----------
    function
        What is called, and can be sent to another process.
    things
        What it is called with, taken as workers become free.
    workers
        Where.
    lost
        Says what stands for the result of a thing that took its worker with it, twice.
    progress
        Called with the number of results that are there.

    Yields
    ------
    Answer
        The results, in order. What the function raises is raised when its turn comes.
    """
    ahead, waiting, size, done = iter(things), deque[tuple[list[Thing], Any]](), 1, 0
    finished = False
    try:
        while True:
            while len(waiting) < workers.window and (batch := list(islice(ahead, size))):
                waiting.append((batch, workers.submit(_batch, function, batch)))
            if not waiting:
                finished = True
                return
            batch, call = waiting.popleft()
            try:
                seconds, results = workers.result(call)
            except WorkerLostError:
                # Alone in what follows, so that it is known whose fault it is.
                seconds, results = WORTH, [_alone(function, thing, workers, lost) for thing in batch]
                waiting = deque((later, old if workers.holds(old) else workers.submit(_batch, function, later)) for later, old in waiting)
            size = max(1, min(workers.most_in_a_batch, 2 * size, int(WORTH * len(batch) / max(seconds, 1e-6))))
            for result in results:
                done += 1
                if progress is not None:
                    progress(done)
                yield result
    finally:
        workers.close(at_once=not finished)


def _alone(function: Callable[[Thing], Answer], thing: Thing, workers: Workers, lost: Callable[[Thing], Answer]) -> Answer:
    """Call a function for one thing that was lost, perhaps by the fault of another: once more, and again if it takes its worker with it."""
    for _ in range(2):
        try:
            result: Answer = workers.result(workers.submit(_batch, function, [thing]))[1][0]
        except WorkerLostError:
            continue
        return result
    return lost(thing)


def _batch(function: Callable[[Thing], Answer], things: list[Thing]) -> tuple[float, list[Answer]]:
    """Call a function of some things, and take the time."""
    began = time.perf_counter()
    results = [function(thing) for thing in things]
    return time.perf_counter() - began, results
