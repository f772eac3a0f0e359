"""A cluster on loopback, of processes as users start them: a scheduler and workers."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

_PATIENCE = 60.0
"""Seconds until the scheduler must have begun."""


@dataclass(frozen=True, slots=True)
class LoopbackCluster:
    """`address` of the scheduler, whose process is `scheduler`; `workers` by their process ids, in order."""

    address: str
    scheduler: subprocess.Popen[bytes]
    workers: list[subprocess.Popen[bytes]] = field(default_factory=list)


@contextmanager
def loopback(workers: int, folder: Path) -> Iterator[LoopbackCluster]:
    """A cluster that ends with the context; nothing of it is restarted."""
    file = folder / "scheduler.json"
    scheduler = _begun("scheduler", "--host", "127.0.0.1", "--port", "0", "--scheduler-file", str(file))
    cluster = None
    try:
        cluster = LoopbackCluster(_address(file), scheduler)
        for _ in range(workers):
            cluster.workers.append(_begun("worker", cluster.address, "--nthreads", "1", "--no-nanny"))
        yield cluster
    finally:
        for process in (*(cluster.workers if cluster else ()), scheduler):
            process.kill()
            process.wait()


def _begun(what: str, *words: str) -> subprocess.Popen[bytes]:
    command = [sys.executable, "-m", "dask", what, *words, "--no-dashboard"]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def _address(file: Path) -> str:
    end = time.monotonic() + _PATIENCE
    while time.monotonic() < end:
        if file.exists() and (text := file.read_text(encoding="utf-8")):
            return str(json.loads(text)["address"])
        time.sleep(0.05)
    raise TimeoutError("the scheduler did not begin")
