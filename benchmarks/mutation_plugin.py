"""What pytest does for mutation.py: the blocks that each test runs, tests in a given order, a limit on each.

A plugin of pytest in the process of one job, which it finds as JSON in the file that MUTATION_JOB names. With
`hits` it writes what each test ran, with `order` it runs only those tests, in that order, until one fails.
"""

from __future__ import annotations

import json
import os
import resource
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

JOB: dict[str, Any] = json.loads(Path(os.environ["MUTATION_JOB"]).read_text(encoding="utf-8"))


class Collect:
    """Notes for each test what it and its fixtures ran, and how long that took of the processor."""

    def __init__(self, out: Path, dumps: Path) -> None:
        import mutation_hits

        self._hits: set[int] = mutation_hits.HITS
        self._out, self._dumps = out, dumps
        self._modules: dict[str, set[int]] = {}
        self._fixtures: dict[int, set[int]] = {}
        self._passed: dict[str, bool] = {}

    @pytest.hookimpl(wrapper=True)
    def pytest_make_collect_report(self, collector: pytest.Collector) -> Iterator[None]:
        self._take()
        result = yield
        self._modules.setdefault(collector.nodeid, set()).update(self._take())
        return result

    @pytest.hookimpl(wrapper=True)
    def pytest_fixture_setup(self, fixturedef: Any) -> Iterator[None]:
        before = self._take()
        result = yield
        self._fixtures[id(fixturedef)] = self._take()
        self._hits.update(before | self._fixtures[id(fixturedef)])
        return result

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: Any) -> Iterator[None]:
        self._take()
        started = _seconds()
        result = yield
        seconds = _seconds() - started
        hits = self._take() | self._modules.get(item.nodeid.split("::")[0], set())
        for definitions in item._fixtureinfo.name2fixturedefs.values():
            for definition in definitions:
                hits |= self._fixtures.get(id(definition), set())
        line = {
            "test": item.nodeid,
            "seconds": round(seconds, 3),
            "passed": self._passed.get(item.nodeid, False),
            "hits": sorted(hits),
        }
        with self._out.open("a", encoding="utf-8") as file:
            file.write(json.dumps(line) + "\n")
        return result

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.when == "call":
            self._passed[report.nodeid] = report.passed
        elif report.failed:
            self._passed[report.nodeid] = False

    def _take(self) -> set[int]:
        """What was run since it was last asked, here and in processes that ended."""
        taken = set(self._hits)
        self._hits.clear()
        for dump in self._dumps.glob("*.json"):
            taken.update(json.loads(dump.read_text()))
            dump.unlink()
        return taken


class Ordered:
    """Runs the tests of a list in its order, each within its time of the processor; the name of one that
    fails is written down."""

    def __init__(self, order: dict[str, float], out: Path) -> None:
        self._order, self._out = order, out
        self._place = {test: place for place, test in enumerate(order)}

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        wanted = [item for item in items if self._listed(item) in self._order]
        items[:] = sorted(wanted, key=lambda item: self._place[self._listed(item)])

    def _listed(self, item: pytest.Item) -> str:
        """How the list names a test: alone, or by its file."""
        file = item.nodeid.split("::")[0]
        return file if file in self._order else item.nodeid

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtest_setup(self, item: pytest.Item) -> None:
        self._out.write_text(item.nodeid, encoding="utf-8")
        longest = self._order[self._listed(item)]
        hard = resource.getrlimit(resource.RLIMIT_CPU)[1]
        resource.setrlimit(resource.RLIMIT_CPU, (int(time.process_time() + longest) + 1, hard))


def _seconds() -> float:
    """Time of the processor, with that of processes that ended."""
    return sum(os.times()[:4])


def pytest_configure(config: pytest.Config) -> None:
    out = Path(JOB["out"])
    if "order" in JOB:
        config.pluginmanager.register(Ordered(JOB["order"], out))
    else:
        config.pluginmanager.register(Collect(out, Path(JOB["dumps"])))
