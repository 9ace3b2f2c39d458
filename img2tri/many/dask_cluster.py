"""A Dask cluster as the place where functions are called.

Scheduling, lost workers, memory and the dashboard are Dask's business: what a lost worker was given is called again by another; a call
that loses several is given up. A cluster that was here before stays when the work ends.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from img2tri.errors import FileError, ParameterError
from img2tri.many.local_workers import AHEAD, MOST_IN_A_BATCH, WorkerLostError
from img2tri.tiles.run_tasks import LOOK_AFTER, Watch

if TYPE_CHECKING:
    from distributed import Client

ANSWER_WITHIN = 30  # seconds until a scheduler has answered


class Cluster:
    """The workers of a Dask cluster."""

    def __init__(self, client: Client) -> None:
        threads = sum(client.nthreads().values())
        self.client, self.calls, self.watch = client, set[Any](), Watch(client, had_workers=threads > 0)
        self.window, self.most_in_a_batch = AHEAD * max(1, threads), MOST_IN_A_BATCH

    def submit(self, function: Callable[..., Any], *given: Any) -> Any:
        """Have a function called on some worker."""
        call = self.client.submit(function, *given, pure=False)
        self.calls.add(call)
        return call

    def result(self, call: Any) -> Any:
        """Wait for a result, as long as there is something to wait for."""
        from distributed import KilledWorker

        try:
            while True:
                try:
                    return call.result(timeout=LOOK_AFTER)
                except TimeoutError:
                    if call.done():
                        return call.result()  # or what the function raised, if that was it
                    if self.watch.forgotten([call.key]):
                        call.cancel()
                        raise WorkerLostError from None
        except KilledWorker as lost:
            raise WorkerLostError from lost
        finally:
            self.calls.discard(call)

    def holds(self, _call: Any, /) -> bool:
        """Keep all calls: the cluster calls them again itself."""
        return True

    def close(self, *, at_once: bool) -> None:
        """Take back what is still to be done; the cluster is its owner's."""
        if at_once and self.calls:
            self.client.cancel(list(self.calls))
        self.calls.clear()


@contextmanager
def connected_to(address: str | None, file: str | None) -> Iterator[Client]:
    """Connect to a scheduler, by its address or a file it wrote, and leave it as it is afterwards.

    Raises
    ------
    FileError
        If nobody answers there.
    ParameterError
        If both are given, or Dask is not installed.
    """
    if address is not None and file is not None:
        raise ParameterError("scheduler: expected an address or a file, found both")
    try:
        from distributed import Client
    except ImportError as missing:
        raise ParameterError(f"scheduler: needs Dask ({missing}): pip install 'img2tri[dask]'") from missing
    try:
        client = Client(address, timeout=ANSWER_WITHIN) if file is None else Client(scheduler_file=file, timeout=ANSWER_WITHIN)
    except (OSError, ValueError, TimeoutError) as problem:
        raise FileError(f"scheduler: expected one at {address or file}, found none that answers ({problem})") from problem
    with client:
        if not client.nthreads():
            raise FileError(f"scheduler: expected workers at {address or file}, found none")
        yield client
