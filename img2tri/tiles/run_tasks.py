"""A function called for each of many tasks, in this process or by the workers of a Dask cluster.

Each task is one entry in the cluster's graph, under a name that its dashboard shows. What all tasks have in common is sent to each worker
once. A task whose worker is lost is done again by another. Now and then, mostly under load, a cluster forgets one, and who waits for it
would wait for ever: so one looks from time to time whether there is something to wait for.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any
from uuid import uuid4

from img2tri.errors import FileError, Img2triError

ROUNDS = 6  # how often tasks are sent again that a cluster has forgotten, as what they need was lost with a worker
PAUSE = 0.5  # seconds, until a cluster has noticed that a worker is lost
LOOK_AFTER = 20.0  # seconds, until one looks whether a task is still with the cluster
WORKERLESS = 120.0  # seconds without any worker, after which none is waited for


def done(
    client: Any,
    stage: str,
    function: Callable[..., Any],
    tasks: Mapping[str, Any],
    shared: tuple[Any, ...],
    share: Callable[[float], object],
) -> Iterator[tuple[str, Any]]:
    """Call a function for each task; yield the name of the task and what the function returned, as it comes.

    Parameters
    ----------
    client
        Of a Dask cluster; None: this process.
    stage
        What is being done, for the dashboard and errors.
    function
        Called with all of `shared` and the task.
    tasks
        By name.
    share
        Told the fraction done.

    Raises
    ------
    Img2triError
        What the function raised; FileError if a task was given up by the cluster, or this has no workers left.
    """
    if client is None:
        for k, (name, task) in enumerate(tasks.items()):
            share(k / len(tasks))
            yield name, function(*shared, task)
        return
    left = dict(tasks)
    for _ in range(ROUNDS):
        for name, result in _round(client, stage, function, left, shared):
            share(1 - len(left) / len(tasks))
            del left[name]
            yield name, result
        if not left:
            return
    raise FileError(f"{stage} {', '.join(list(left)[:3])}: the cluster has forgotten this {ROUNDS} times; what is done stays")


def _round(
    client: Any, stage: str, function: Callable[..., Any], tasks: Mapping[str, Any], shared: tuple[Any, ...]
) -> Iterator[tuple[str, Any]]:
    """Send tasks once, and yield the results of those that were not forgotten."""
    from distributed import as_completed

    try:
        kept, once = client.scatter(shared, broadcast=True, hash=False), uuid4().hex
    except OSError:  # a worker was lost on the way
        time.sleep(PAUSE)
        return
    futures = {client.submit(_call, function, kept, task, key=f"{stage}-{name}-{once}", pure=False): name for name, task in tasks.items()}
    left, watch = set(futures), Watch(client)
    try:
        while left:
            try:
                for future in as_completed(list(left), timeout=LOOK_AFTER):
                    left.discard(future)
                    if not future.cancelled():
                        yield futures[future], _result(future, f"{stage} {futures[future]}")
            except TimeoutError:
                if watch.forgotten([future.key for future in left]):
                    return
    finally:
        client.cancel(list(futures))


class Watch:
    """Looks after calls that a cluster may have forgotten, or has nobody left for."""

    def __init__(self, client: Any, *, had_workers: bool = True) -> None:
        """Look after the calls of a client; a cluster that has had no workers yet is waited for."""
        self.client, self.had_workers, self.alone_since = client, had_workers, math.inf

    def forgotten(self, keys: Iterable[Any]) -> bool:
        """Tell whether none of the calls of these keys is with a worker, while there is one that has nothing to do.

        A call that is taken for forgotten though its turn was to come is made twice, which costs time and changes nothing.

        Raises
        ------
        FileError
            If there has been no worker for long, where there were some.
        """
        at = [set(calls) for calls in self.client.processing().values()]
        now = time.monotonic()
        self.had_workers |= bool(at)
        self.alone_since = math.inf if at else min(self.alone_since, now)
        if self.had_workers and now - self.alone_since > WORKERLESS:
            raise FileError(f"cluster: expected workers, found none for {WORKERLESS:g} seconds; start some, or go on without the cluster")
        return any(not calls for calls in at) and set(keys).isdisjoint(set().union(*at))


def _result(future: Any, name: str) -> Any:
    try:
        return future.result()
    except Img2triError:
        raise
    except Exception as problem:  # a worker that is lost again and again, or a cluster that closes
        raise FileError(f"{name}: {type(problem).__name__}: {problem}; what is done stays") from problem


def _call(function: Callable[..., Any], shared: tuple[Any, ...], task: Any) -> Any:
    return function(*shared, task)
