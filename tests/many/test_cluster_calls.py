"""A call that a cluster has forgotten is made again, by many images and by tiles; one that only takes its time is not."""

from __future__ import annotations

import time
from contextlib import contextmanager
from functools import partial

import pytest

from img2tri.errors import FileError
from img2tri.many import dask_cluster
from img2tri.many.in_order import in_order
from img2tri.tiles import run_tasks

distributed = pytest.importorskip("distributed")


@contextmanager
def forgetful(monkeypatch):
    """A cluster of two workers in this process, and a client of which the second call waits for a worker that never comes."""
    for module in (dask_cluster, run_tasks):
        monkeypatch.setattr(module, "LOOK_AFTER", 0.3)
    calls = []
    with (
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=False, dashboard_address=None) as cluster,
        distributed.Client(cluster) as client,
    ):
        submit = client.submit

        def submitted(*given, **how):
            calls.append(given)
            return submit(*given, **how | ({"workers": ["tcp://127.0.0.1:1"]} if len(calls) == 2 else {}))

        monkeypatch.setattr(client, "submit", submitted)
        yield client, calls


def slowly(factor, number):
    time.sleep(1.0 if number == 0 else 0.0)
    return factor * number


def test_a_forgotten_call_is_made_again(monkeypatch):
    with forgetful(monkeypatch) as (client, calls):
        tasks = {str(number): number for number in range(4)}
        found = dict(run_tasks.done(client, "double", slowly, tasks, (2,), lambda _: None))
        assert found == {str(number): 2 * number for number in range(4)}
        assert len(calls) == 5
        calls.clear()
        assert list(in_order(partial(slowly, 2), range(4), dask_cluster.Cluster(client), lost=pytest.fail)) == [0, 2, 4, 6]
        assert len(calls) == 5


class Deserted:
    """A client of a cluster that has lost all its workers."""

    def processing(self):
        return {}


def test_a_cluster_without_workers_is_not_waited_for(monkeypatch):
    monkeypatch.setattr(run_tasks, "WORKERLESS", 0.05)
    waiting = run_tasks.Watch(Deserted(), had_workers=False)
    assert not waiting.forgotten(["a"])
    watch = run_tasks.Watch(Deserted())
    assert not watch.forgotten(["a"])
    time.sleep(0.06)
    with pytest.raises(FileError, match="expected workers, found none for 0.05 seconds; start some"):
        watch.forgotten(["a"])
    assert not waiting.forgotten(["a"])
    watch.client = type("Back", (), {"processing": lambda self: {"one": ("b",), "other": ()}})()
    assert watch.forgotten(["a"])
    assert not watch.forgotten(["a", "b"])
    watch.client = Deserted()
    assert not watch.forgotten(["a"])
