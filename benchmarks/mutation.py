"""Small changes to the code, each of which a test should notice; what no test notices is printed.

`python benchmarks/mutation.py` changes one thing at a time in a copy of the checkout (a comparison, a
constant, a sign, `and` for `or`, a statement or a guard dropped, two arguments swapped) and runs the tests
that run the changed lines. Which tests those are is found once, by running all of them in a marked copy, and
kept; this takes about as long as the tests, and a later run does it again for the test files that changed. A
change that a test fails for, or takes much longer for, is noticed; so is one that mypy refuses, which a test
runs. Modules that changed since they were last tried come first, then those that were tried longest ago
(`--draw all` draws from all alike). What was tried with a seed is kept, and a run that was stopped goes on
where it was. Changes that make no difference are listed in benchmarks/mutation_equal.txt, each with its
reason, and are neither tried nor printed. The command reports, and always exits with 0: it is no gate.

A change costs 5 to 60 seconds of a processor: 100 changes take about half an hour on two idle ones.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import multiprocessing
import random
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

import mutation_runs as runs
from mutants import MODULE, SOURCES, Change, Site, changed, sites
from mutation_tests import Knowledge, collect, test_files

ROOT = Path(__file__).resolve().parents[1]
RESULTS = "results.jsonl"
EQUAL = Path(__file__).with_name("mutation_equal.txt")
_NOW = Path(".job") / "now"
_WARMS = "tests/cli/test_planning_cases.py"
"""Runs all planners."""
_WARM_SECONDS = 900.0


@dataclass(frozen=True, slots=True)
class Result:
    """What became of one change: `outcome` is noticed, survived, or unreached where no test runs it."""

    key: str
    module: str
    sha: str
    seed: int
    line: int
    outcome: str
    by: str
    tests: int
    left_out: int
    seconds: float
    at: float


def sha(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()[:16]


def reviewed(path: Path) -> dict[str, str]:
    """Changes that make no difference, each with its reason: `# reason`, and below it the changes."""
    found, reason = {}, ""
    for line in path.read_text(encoding="utf-8").splitlines() if path.exists() else []:
        if line.startswith("#"):
            reason = line.removeprefix("#").strip()
        elif line.strip():
            found[line.strip()] = reason
    return found


def read_results(path: Path) -> list[Result]:
    """All that was tried; a last line that was cut is taken away."""
    text = path.read_text(encoding="utf-8") if path.exists() else ""
    whole = text[: text.rfind("\n") + 1]
    if whole != text:
        path.write_text(whole, encoding="utf-8")
    return [Result(**json.loads(line)) for line in whole.splitlines()]


# ---- which changes


def modules() -> dict[str, Path]:
    paths = sorted(SOURCES.rglob("*.py"))
    return {path.relative_to(SOURCES).as_posix(): path for path in paths if path.read_text().strip()}


def in_turn(tried: Iterable[Result], rng: random.Random) -> Iterator[str]:
    """Modules for ever: changed since they were tried, then never tried, then the longest ago."""
    last: dict[str, Result] = {result.module: result for result in tried}
    paths = modules()

    def rank(name: str) -> tuple[bool, float]:
        before = last.get(name)
        return (before is None or before.sha == sha(paths[name]), before.at if before else 0.0)

    names = list(paths)
    rng.shuffle(names)
    while True:
        yield from sorted(names, key=rank)


def alike(rng: random.Random) -> Iterator[str]:
    """Modules for ever, each as often as its length."""
    paths = modules()
    names = list(paths)
    weights = [len(paths[name].read_bytes()) for name in names]
    while True:
        yield from rng.choices(names, weights, k=100)


def draw(names: Iterator[str], count: int, seed: int) -> list[Change]:
    """Changes of the modules: a line of each, and one of the line's changes, all alike likely.

    What is drawn of a module depends on no other one, so that a run goes on although some have changed.
    """
    found: dict[str, Change] = {}
    times: Counter[str] = Counter()
    known: dict[str, list[list[Site]]] = {}
    paths = modules()
    for name in names:
        if len(found) >= count:
            break
        text = paths[name].read_text(encoding="utf-8")
        if name not in known:
            by_line: dict[int, list[Site]] = {}
            for site in sites(name, text):
                by_line.setdefault(site.node.lineno, []).append(site)
            known[name] = list(by_line.values())
        times[name] += 1
        rng = random.Random(f"{seed} {name} {times[name]}")
        if known[name]:
            change = changed(rng.choice(rng.choice(known[name])), text)
            if change is not None:
                found.setdefault(change.key, change)
    return list(found.values())


# ---- trying them


class Bench:
    """A copy of the checkout in which changes are tried, one after the other."""

    def __init__(
        self, folder: Path, worker: int, knowledge: Knowledge, budget: float, seed: int, types: bool
    ) -> None:
        self.copy = folder / f"copy-{worker}"
        self._folder, self._knowledge, self._budget, self._seed = folder, knowledge, budget, seed
        self._sound: dict[str, bool] = {}
        self._kills: Counter[tuple[str, str]] = Counter()
        self._kernels = folder / "kernels"
        self._types_are_sound = None if types else False
        runs.make_copy(self.copy)

    def warm(self) -> None:
        """Compile what planners run, which a test that is run alone has no time for."""
        runs.compile_modules(self.copy)
        self._run([_WARMS], {_WARMS: _WARM_SECONDS}, _WARM_SECONDS, self._kernels)

    def try_change(self, change: Change) -> Result:
        started = time.perf_counter()
        chosen = self._knowledge.tests_for(change, self._budget, self._kills)
        by, done = "", 0
        for stage in chosen.stages:
            by = self._noticing(stage, change)
            done += len(stage)
            if by:
                break
        if not by and self._is_refused_by_type(change):
            by, done = runs.TYPES, done + 1
        if by:
            self._kills[change.module, by] += 1
            if change.block.endswith(MODULE):
                self._kills[change.kind, by] += 1
        outcome = "noticed" if by else "survived" if done else "unreached"
        return Result(
            change.key,
            change.module,
            sha(SOURCES / change.module),
            self._seed,
            change.line,
            outcome,
            by,
            done,
            chosen.left_out,
            round(time.perf_counter() - started, 1),
            time.time(),
        )

    def _noticing(self, stage: tuple[str, ...], change: Change) -> str:
        """The first test of a stage that fails with a change, and does not fail without it; "" for none."""
        left = tuple(test for test in stage if self._sound.get(test, True))
        while left:
            with runs.applied(self.copy, self._kernels, change) as changed_kernels:
                by = self._failing(left, changed_kernels)
            if by and by not in self._sound:
                self._sound[by] = not self._failing((by,), self._kernels)
            if not by or self._sound[by]:
                return by
            left = left[left.index(by) + 1 :]
        return ""

    def _is_refused_by_type(self, change: Change) -> bool:
        """Whether the type checker refuses the change, and nothing without it."""
        if self._types_are_sound is None:
            self._types_are_sound = runs.well_typed(self.copy)
        if not self._types_are_sound:
            return False
        with runs.applied(self.copy, self._kernels, change):
            return not runs.well_typed(self.copy)

    def _failing(self, tests: tuple[str, ...], kernels: Path) -> str:
        """The first of some tests that fails, or takes too long; "" for none."""
        order = {test: self._knowledge.limit(test) for test in tests}
        files = list(dict.fromkeys(test.split("::")[0] for test in tests))
        ended = self._run(files, order, self._knowledge.limit_of_all(tests), kernels)
        if ended.code in (0, 5):
            return ""
        return (self.copy / _NOW).read_text() or tests[0]

    def _run(self, files: list[str], order: dict[str, float], limit: float, kernels: Path) -> runs.Ended:
        now = self.copy / _NOW
        now.parent.mkdir(exist_ok=True)
        now.write_text("")
        return runs.run(self.copy, files, {"out": str(now), "order": order}, kernels, limit, now.parent)


def work(worker: int, todo: list[Change], asked: argparse.Namespace, claims: Path) -> None:
    """Try changes until all are tried by this process or another, or the time is over."""
    knowledge = Knowledge(asked.keep, asked.tests)
    bench = Bench(asked.keep, worker, knowledge, asked.per_change, asked.seed, not asked.quick)
    if not asked.quick:
        bench.warm()
    for place, change in enumerate(todo, start=1):
        if time.time() > asked.until:
            break
        try:
            (claims / str(place)).touch(exist_ok=False)
        except FileExistsError:
            continue
        result = bench.try_change(change)
        with (asked.keep / RESULTS).open("a", encoding="utf-8") as file:
            file.write(json.dumps(asdict(result)) + "\n")
        print(
            f"{place:4} of {len(todo)}: {result.seconds:5.0f} s  {result.outcome:9}  {change.key}",
            file=sys.stderr,
            flush=True,
        )


def try_all(todo: list[Change], asked: argparse.Namespace) -> None:
    with tempfile.TemporaryDirectory() as claims:
        processes = [
            multiprocessing.get_context("fork").Process(target=work, args=(worker, todo, asked, Path(claims)))
            for worker in range(asked.workers)
        ]
        for process in processes:
            process.start()
        for process in processes:
            process.join()


def report(changes: list[Change], results: list[Result], seed: int) -> None:
    """What became of the changes, and those to look at."""
    equal = reviewed(EQUAL)
    of_change = {result.key: result for result in results if result.seed == seed}
    tried = [(change, of_change[change.key]) for change in changes if change.key in of_change]
    noticed = sum(result.outcome == "noticed" for _, result in tried)
    same = [result for _, result in tried if result.outcome != "noticed" and result.key in equal]
    new = [(c, result) for c, result in tried if result.outcome != "noticed" and result.key not in equal]
    for change, result in new:
        left = f", {result.left_out} left out" if result.left_out else ""
        print(
            f"src/cleancli/{change.module}:{change.line}: {change.kind}: {change.before}  ->  {change.after}"
        )
        print(f"    {result.outcome} ({result.tests} tests{left}); {change.block}")
    counts = f"{noticed} noticed, {len(same)} make no difference, {len(new)} not noticed"
    print(f"{len(tried)} changes tried: {counts}")
    if noticed + len(new):
        print(f"noticed of those that may make a difference: {noticed / (noticed + len(new)):.1%}")


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--changes", type=int, default=100, help="how many changes to try (100)")
    parser.add_argument("--minutes", type=float, default=60.0, help="begin no change after this time (60)")
    parser.add_argument("--seed", type=int, default=1, help="draws other changes (1)")
    parser.add_argument("--draw", choices=("in-turn", "all"), default="in-turn", help="from which modules")
    parser.add_argument("--module", action="append", help="only this one, such as planning/planners/exact.py")
    parser.add_argument("--per-change", type=float, default=60.0, help="seconds of tests for a change (60)")
    parser.add_argument("--workers", type=int, default=2, help="processes (2)")
    parser.add_argument(
        "--keep", type=Path, default=ROOT / ".cache" / "mutation", help="what is known and tried"
    )
    parser.add_argument(
        "--collect", action="store_true", help="find out which tests run which lines, no more"
    )
    parser.add_argument(
        "--known", action="store_true", help="with what is known of tests, though some changed"
    )
    parser.add_argument("--list", action="store_true", help="print the changes that were drawn, try none")
    parser.add_argument(
        "--quick", action="store_true", help="two changes of one small module, by its own tests"
    )
    parser.add_argument("--tests", nargs="+", metavar="FILE", help="only these test files")
    asked = parser.parse_args()
    if asked.quick:
        asked.changes, asked.workers, asked.module = 2, 1, ["language/record.py"]
        asked.tests = ["tests/language/test_record.py"]
    asked.tests = asked.tests or test_files()
    asked.until = time.time() + 60 * asked.minutes
    return asked


def main() -> int:
    asked = parse()
    folder: Path = asked.keep
    folder.mkdir(parents=True, exist_ok=True)
    tried = read_results(folder / RESULTS)
    rng = random.Random(asked.seed)
    earlier = [result for result in tried if result.seed != asked.seed]
    names = alike(rng) if asked.draw == "all" else in_turn(earlier, rng)
    if asked.module:
        names = iter(asked.module * 50 * asked.changes)
    changes = draw(names, asked.changes, asked.seed)
    if asked.list:
        print(*(f"{change.line:5} {change.key}" for change in changes), sep="\n")
        return 0
    if not asked.quick:
        runs.load_libraries()
    runs.keep_kernels_by_their_own_text()
    if not asked.known:
        collect(folder, asked.workers, asked.tests, asked.module if asked.quick else None)
    if asked.collect:
        return 0
    done = {(result.key, result.sha) for result in tried if result.seed == asked.seed}
    todo = [
        c for c in changes if (c.key, sha(SOURCES / c.module)) not in done and c.key not in reviewed(EQUAL)
    ]
    if todo:
        try_all(todo, asked)
    report(changes, read_results(folder / RESULTS), asked.seed)
    return 0


if __name__ == "__main__":
    sys.exit(main())
