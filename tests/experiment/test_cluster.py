"""A cluster on loopback gives the rows that this process gives, whichever workers are lost."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from distributed import KilledWorker
from distributed.comm.core import CommClosedError

from cleancli.experiment import cluster
from cleancli.experiment.cluster import NoCluster, on_cluster, remote_cluster
from cleancli.experiment.episode import Finished
from cleancli.experiment.schedule import GivenUp, Pool, rows, scheduled
from cleancli.study.row import comparable
from support.dask_cluster import loopback
from support.studies import SYMBOLIC, opened, rows_here

STUDIES = opened(SYMBOLIC.replace("runs      = 2", "runs = 3"))


def pool(client: Any) -> Pool:
    return lambda series, known: on_cluster(client, series, known)


def test_a_cluster_gives_the_same_rows_though_a_worker_is_killed(tmp_path: Path) -> None:
    known: dict[str, Finished] = {}
    finished = []
    with loopback(3, tmp_path) as made, remote_cluster(made.address) as client:
        client.wait_for_workers(3)
        for outcome in scheduled(STUDIES, known, pool(client)):
            assert isinstance(outcome, Finished)
            finished.append(outcome.row.key)
            if len(finished) == 4:
                os.kill(made.workers[1].pid, signal.SIGKILL)
        assert len(client.nthreads()) == 2
    assert len(finished) == len(set(finished)) == 24
    assert tuple(map(comparable, rows(STUDIES, known))) == rows_here(STUDIES)


def test_a_scheduler_that_goes_away_is_told_and_what_is_finished_stays(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    known: dict[str, Finished] = {}
    with loopback(1, tmp_path) as made, remote_cluster(made.address) as client:

        def until_it_goes() -> Iterator[None]:
            for _ in scheduled(STUDIES, known, pool(client)):
                if len(known) == 2:
                    made.scheduler.kill()
                yield

        with pytest.raises(NoCluster, match="the scheduler has gone"):
            list(until_it_goes())
    assert 2 <= len(known) < 24
    rows_here(STUDIES, known)
    assert len(known) == 24


def test_a_scheduler_that_goes_away_while_it_is_asked_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A connection that is reset at any moment is the scheduler's end, and no traceback."""

    def reset(*_: object) -> None:
        raise CommClosedError("in <TCP>: ConnectionResetError")

    monkeypatch.setattr(cluster, "_outcome", reset)
    with (
        loopback(1, tmp_path) as made,
        remote_cluster(made.address) as client,
        pytest.raises(NoCluster, match="the scheduler has gone: in <TCP>"),
    ):
        list(scheduled(STUDIES, {}, pool(client)))


def test_without_a_scheduler_or_workers_it_says_which(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cluster, "PATIENCE", 1.0)
    with (
        pytest.raises(NoCluster, match=r"no scheduler answers at tcp://127\.0\.0\.1:9"),
        remote_cluster("tcp://127.0.0.1:9"),
    ):
        pass
    with pytest.raises(NoCluster, match="no scheduler answers at nonsense"), remote_cluster("nonsense://x"):
        pass
    with (
        loopback(0, tmp_path) as made,
        pytest.raises(NoCluster, match="has no worker"),
        remote_cluster(made.address),
    ):
        pass


def test_an_episode_that_workers_die_of_is_given_up() -> None:
    class Killed:
        def result(self) -> None:
            raise KilledWorker("episode", None, 4)  # type: ignore[arg-type]

    series = STUDIES[0].blocks[0][0]
    found = cluster._outcome(Killed(), series, 1)  # type: ignore[arg-type]
    assert found == GivenUp(series[1], "4 workers were lost with it")
