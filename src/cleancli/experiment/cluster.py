"""Episodes on Dask: processes of this machine, or a cluster that runs already.

Each episode is a task of its own, submitted with what those before it have seen; few more than there are
workers wait at the scheduler, however many there are to come. Of a lost worker its current episode alone is
lost, and is carried out again by another.
"""

from __future__ import annotations

import logging
import signal
import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

from dask import config
from distributed import Client, Future, KilledWorker, LocalCluster, WorkerPlugin, as_completed
from distributed.client import FutureCancelledError
from distributed.comm.core import CommClosedError

from cleancli.experiment.episode import Episode, Finished, carried_out
from cleancli.experiment.schedule import GivenUp, Known, due
from cleancli.experiment.series import Series
from cleancli.learning.evidence import Evidence

LOSSES = 3
"""Lost workers after which an episode is given up: it may be what they die of."""

AHEAD = 2
"""Episodes at the scheduler for each worker, so that none waits for the next."""

PATIENCE = 20.0
"""Seconds until a scheduler must have answered, and have a worker."""

_REFRESH = 2.0
"""Seconds after which the workers are counted anew."""


Task = Callable[[Episode, Evidence], Finished]
"""What is done with an episode, and with what those before it in its series have seen."""


class NoCluster(OSError):
    """There is no scheduler, it has no worker, or it has gone; the message says which."""


class _LeaveInterrupts(WorkerPlugin):
    """Ctrl-C is for the process that began the workers, which ends them."""

    name = "leave-interrupts"

    def setup(self, worker: object) -> None:
        signal.signal(signal.SIGINT, signal.SIG_IGN)


@contextmanager
def local_cluster(jobs: int) -> Iterator[Client]:
    """So many processes of this machine, with a thread each."""
    with (
        config.set({"distributed.scheduler.allowed-failures": LOSSES}),
        LocalCluster(
            n_workers=jobs,
            threads_per_worker=1,
            memory_limit=0,
            dashboard_address="127.0.0.1:0",
            silence_logs=logging.CRITICAL,
        ) as cluster,
        Client(cluster) as client,
    ):
        client.register_plugin(_LeaveInterrupts())
        yield client


@contextmanager
def remote_cluster(address: str) -> Iterator[Client]:
    """A cluster that runs already. Raises NoCluster."""
    try:
        client = Client(address, timeout=PATIENCE)
    except (OSError, ValueError) as error:
        raise NoCluster(f"no scheduler answers at {address}: {error}") from None
    with client:
        try:
            client.wait_for_workers(1, timeout=PATIENCE)
        except TimeoutError:
            raise NoCluster(f"the scheduler at {address} has no worker: start some first") from None
        yield client


def on_cluster(
    client: Client, series: Sequence[Series], known: Known, task: Task = carried_out
) -> Iterator[Finished | GivenUp]:
    """A pool (`schedule.Pool`) of a cluster's workers, which do the `task` with each episode. Raises
    NoCluster where the scheduler goes away."""
    try:
        yield from _done_with(client, series, known, task)
    except FutureCancelledError as error:
        raise NoCluster(f"the scheduler has gone: {error.reason}") from None
    except CommClosedError as error:  # it went while it was asked for something
        raise NoCluster(f"the scheduler has gone: {error}") from None


def _done_with(
    client: Client, series: Sequence[Series], known: Known, task: Task
) -> Iterator[Finished | GivenUp]:
    """What `on_cluster` gives; raises what Dask does where the scheduler goes away."""
    waiting = deque((each, *due(each, known)) for each in series)
    running: dict[Future[Finished], tuple[Series, int]] = {}
    completed = as_completed()
    size, counted = 0, -_REFRESH
    while waiting or running:
        if time.monotonic() - counted > _REFRESH:
            size, counted = AHEAD * max(1, len(client.nthreads())), time.monotonic()
        while waiting and len(running) < size:
            each, index, evidence = waiting.popleft()
            episode = each[index]
            future = client.submit(task, episode, evidence, key=f"episode-{episode.key}")
            running[future] = each, index
            completed.add(future)
        future = next(completed)
        each, index = running.pop(future)
        outcome = _outcome(future, each, index)
        if isinstance(outcome, Finished) and index + 1 < len(each):
            waiting.appendleft((each, index + 1, outcome.evidence))
        yield outcome


def _outcome(future: Future[Finished], series: Series, index: int) -> Finished | GivenUp:
    try:
        finished = future.result()
    except KilledWorker:
        return GivenUp(series[index], f"{LOSSES + 1} workers were lost with it")
    assert isinstance(finished, Finished)
    return finished
