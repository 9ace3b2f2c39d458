"""Many jobs -> their outcomes, in the order of the jobs: one after the other here, or several at once by the workers of `img2tri.many`."""

from __future__ import annotations

import os
from argparse import Namespace
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import closing, contextmanager
from dataclasses import replace
from functools import partial

from img2tri.cli.job import Job, Outcome
from img2tri.cli.meshing_job import held, make
from img2tri.errors import ParameterError, integer
from img2tri.many.in_order import in_order
from img2tri.many.local_workers import Workers, local_workers


@contextmanager
def workers_of(arguments: Namespace, jobs: int) -> Iterator[Workers]:
    """Find the workers that were asked for."""
    if arguments.scheduler is None and arguments.scheduler_file is None:
        yield local_workers(min(integer("workers", 1 if arguments.workers is None else arguments.workers, least=1), max(1, jobs)))
        return
    if arguments.workers is not None:
        raise ParameterError("workers: expected without a scheduler, whose cluster has its own")
    from img2tri.many.dask_cluster import Cluster, connected_to

    with connected_to(arguments.scheduler, arguments.scheduler_file) as client:
        yield Cluster(client)


def run(jobs: Sequence[Job], where: Workers, progress: Callable[[int, str, float], None]) -> Generator[Outcome]:
    """Do jobs.

    Parameters
    ----------
    jobs
        What is to be done.
    where
        The workers; the outcomes are the same for all.
    progress
        Called with the number of a job, the name of a stage (where it is done here) and the fraction done; what it raises ends the work.

    Yields
    ------
    Outcome
        One for each job, in their order, as soon as it and those before it are there.
    """
    if where.window == 1:
        for number, job in enumerate(jobs):
            outcome = make(job, partial(progress, number))
            progress(number, "done", 1.0)
            yield outcome
        return
    progress(0, "meshing", 0.0)
    things = (held(replace(job, folder=os.getcwd())) for job in jobs)  # stdin is read here, where it is
    with closing(in_order(_elsewhere, things, where, lost=_lost)) as outcomes:
        for number, outcome in enumerate(outcomes):
            progress(number, "done", 1.0)
            yield outcome


def _elsewhere(thing: Job | Outcome) -> Outcome:
    return thing if isinstance(thing, Outcome) else make(thing, lambda *_: None)


def _lost(thing: Job | Outcome) -> Outcome:
    """Say what became of a job that took its worker with it."""
    return Outcome(thing.image, problem="the process that meshed it ended twice; if memory ran out, fewer --workers need less")
