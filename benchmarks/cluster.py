"""What Dask costs an episode: `python benchmarks/cluster.py [--part PART ...] [--episodes N] ...`.

`symbolic`: episodes in the symbolic world through a scheduler and workers of this machine, each a process:
how many a second, what an episode costs the scheduler and the process that submits, beside what it computes
itself, and how much memory each process takes in the end and has taken more than when it began.
`sleeping`: the same with episodes that sleep for `--sleep` seconds, on `--workers` workers in one process, so
that a hundred fit on this machine: their one interpreter does the work of all, and so the rate is one that a
cluster of as many machines surpasses.
`faults`: three workers, of which one is killed in the middle and one paused for `--pause` seconds: every
episode once, and the rows of this process.

About ten minutes of CPU with 10,000 episodes; `--quick` (50 episodes, 10 workers) half a minute.
"""

from __future__ import annotations

import argparse
import os
import signal
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path

import psutil
from dask import config
from distributed import Client, LocalCluster

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from cleancli.experiment.cluster import on_cluster, remote_cluster
from cleancli.experiment.episode import Episode, Finished, carried_out
from cleancli.experiment.schedule import here, rows, scheduled
from cleancli.experiment.series import OpenedStudy, open_studies
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.learning.evidence import Evidence
from cleancli.study.row import comparable
from support.dask_cluster import LoopbackCluster, loopback

PARTS = ("symbolic", "sleeping", "faults")


def study(episodes: int, estimator: str = "none", series: int = 1) -> tuple[OpenedStudy, ...]:
    """So many episodes of a small problem, each of some hundredths of a second."""
    text = f"""study many {{
      scene = three_areas  strategy = plan_2  samples = 50  estimator = {estimator}
      episodes = {series}  runs = {episodes // series}
    }}"""
    return open_studies(Source("many.nid", text))


def asleep(like: Finished, seconds: float, episode: Episode, evidence: Evidence) -> Finished:
    """Sleeps instead, and tells what another episode came to."""
    time.sleep(seconds)
    return Finished(replace(like.row, key=episode.key), evidence)


def megabytes(process: int | psutil.Process) -> float:
    """What a process holds in memory."""
    found = psutil.Process(process) if isinstance(process, int) else process
    return float(found.memory_info().rss) / 2**20


def symbolic(episodes: int, workers: int) -> Iterator[str]:
    """Episodes through processes of this machine."""
    studies = study(episodes)
    with tempfile.TemporaryDirectory() as place, loopback(workers, Path(place)) as cluster:
        processes = {"scheduler": cluster.scheduler.pid, "submits": os.getpid()}
        processes |= {f"worker {n}": each.pid for n, each in enumerate(cluster.workers, start=1)}
        with remote_cluster(cluster.address) as client:
            client.wait_for_workers(workers)
            known: dict[str, Finished] = {}
            _warmed(client, studies)
            before = {name: (megabytes(pid), _cpu(pid)) for name, pid in processes.items()}
            began = time.perf_counter()
            _all(client, studies, known)
            took = time.perf_counter() - began
            after = {name: (megabytes(pid), _cpu(pid)) for name, pid in processes.items()}
    own = sum(each.row.cpu for each in known.values())
    yield f"{len(known)} episodes on {workers} workers in {took:.1f} s: {len(known) / took:.0f} a second"
    yield f"computed by an episode itself: {1000 * own / len(known):.1f} ms of CPU"
    yield "| process | ms of CPU an episode | MB in the end | MB more |"
    yield "|---|---|---|---|"
    for name, (memory, cpu) in after.items():
        spent = 1000 * (cpu - before[name][1]) / len(known)
        yield f"| {name} | {spent:.2f} | {memory:.0f} | {memory - before[name][0]:.0f} |"


def sleeping(episodes: int, workers: int, seconds: float) -> Iterator[str]:
    """Many workers, all in this process, and a scheduler that they reach by TCP as others would."""
    studies = study(episodes)
    like = carried_out(studies[0].blocks[0][0][0])
    with (
        config.set({"distributed.worker.profile.enabled": False}),  # a hundred would watch this process
        LocalCluster(
            n_workers=workers,
            threads_per_worker=1,
            processes=False,
            protocol="tcp://",
            dashboard_address=None,
            memory_limit=0,
        ) as cluster,
        Client(cluster) as client,
    ):
        known: dict[str, Finished] = {}
        memory, cpu, began = megabytes(os.getpid()), time.process_time(), time.perf_counter()
        task = partial(asleep, like, seconds)
        for _ in scheduled(studies, known, lambda series, k: on_cluster(client, series, k, task)):
            pass
        took, spent = time.perf_counter() - began, time.process_time() - cpu
        more = megabytes(os.getpid()) - memory
    ideal = len(known) * seconds / workers
    yield f"{len(known)} episodes of {seconds:g} s on {workers} workers: {took:.1f} s, at best {ideal:.1f}"
    yield f"{1000 * spent / len(known):.2f} ms of CPU an episode, for scheduler, workers and submitting"
    yield f"{more:.0f} MB more in the end"


def faults(episodes: int, pause: float) -> Iterator[str]:
    """One worker killed, one paused, in the middle."""
    studies = study(episodes, "decreasing_m", 2)
    known: dict[str, Finished] = {}
    carried: list[str] = []
    with (
        tempfile.TemporaryDirectory() as place,
        loopback(3, Path(place)) as cluster,
        remote_cluster(cluster.address) as client,
    ):
        client.wait_for_workers(3)
        for outcome in scheduled(studies, known, lambda s, k: on_cluster(client, s, k)):
            assert isinstance(outcome, Finished), outcome
            carried.append(outcome.row.key)
            if len(carried) == episodes // 4:
                os.kill(cluster.workers[0].pid, signal.SIGKILL)
                _pause(cluster, pause)
    alone: dict[str, Finished] = {}
    for _ in scheduled(studies, alone, here):
        pass
    pairs = zip(rows(studies, known), rows(studies, alone), strict=True)
    wrong = sum(comparable(one) != comparable(other) for one, other in pairs)
    once = len(carried) == len(set(carried)) == episodes
    yield f"{len(carried)} episodes, {'each once' if once else 'NOT each once'}; rows that differ: {wrong}"
    if wrong or not once:
        raise SystemExit(1)


def _pause(cluster: LoopbackCluster, seconds: float) -> None:
    paused = cluster.workers[1].pid
    os.kill(paused, signal.SIGSTOP)
    threading.Timer(seconds, os.kill, (paused, signal.SIGCONT)).start()


def _warmed(client: Client, studies: tuple[OpenedStudy, ...]) -> None:
    """Every worker loads the libraries once; the seeds are others."""
    first = studies[0].blocks[0][0][0]
    client.run(carried_out, first)


def _all(client: Client, studies: tuple[OpenedStudy, ...], known: dict[str, Finished]) -> None:
    for _ in scheduled(studies, known, lambda series, k: on_cluster(client, series, k)):
        pass


def _cpu(process: int) -> float:
    times = psutil.Process(process).cpu_times()
    return float(times.user + times.system)


def main() -> None:
    """Carry out the parts, and print what they cost."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--part", nargs="+", choices=PARTS, default=list(PARTS))
    parser.add_argument("--episodes", type=int, default=10_000)
    parser.add_argument("--processes", type=int, default=2, help="workers of `symbolic`")
    parser.add_argument("--workers", type=int, default=100, help="of `sleeping`")
    parser.add_argument("--sleep", type=float, default=1.0)
    parser.add_argument("--pause", type=float, default=60.0)
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args()
    if options.quick:
        options.episodes, options.workers, options.sleep, options.pause = 48, 8, 0.05, 2.0
    if "symbolic" in options.part:
        print(*symbolic(options.episodes, options.processes), sep="\n")
    if "sleeping" in options.part:
        print(*sleeping(options.episodes, options.workers, options.sleep), sep="\n")
    if "faults" in options.part:
        print(*faults(min(options.episodes, 1000), options.pause), sep="\n")


if __name__ == "__main__":
    main()
