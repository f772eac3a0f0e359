"""Which tests run which blocks: found in a marked copy, kept test file by test file, asked for a change."""

from __future__ import annotations

import hashlib
import json
import multiprocessing
import shutil
import sys
from collections import Counter, defaultdict
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import mutation_runs as runs
from mutants import MODULE, Change, instrumented

ROOT = Path(__file__).resolve().parents[1]
_FIRST_TESTS = 20
_FIRST_SECONDS = 4.0
_FIRST_FILES = 3
_CASES = 5
_FILE_SECONDS = 150.0
UNKNOWN_SECONDS = 5.0
_LEAST_LIMIT = 15.0
_TIMES_AS_LONG = 8.0


@dataclass(frozen=True, slots=True)
class Chosen:
    """Tests for a change, the likeliest and quickest first."""

    stages: tuple[tuple[str, ...], ...]
    left_out: int


# ---- finding out


def collect(folder: Path, workers: int, files: list[str], modules: list[str] | None) -> None:
    """Run those of the test files that changed since they were last run in the marked copy, and keep what
    they ran; of all modules, unless `modules` names some."""
    coverage = folder / "coverage"
    coverage.mkdir(exist_ok=True)
    todo = [file for file in files if _sha_of(coverage / _name(file)) != _sha(ROOT / file)]
    if not todo:
        return
    marked = folder / "marked"
    _mark(marked, folder / "blocks.json", modules)
    shares = [todo[first::workers] for first in range(workers)]
    processes = [
        multiprocessing.get_context("fork").Process(target=_collect, args=(folder, number, share))
        for number, share in enumerate(shares)
    ]
    for process in processes:
        process.start()
    for process in processes:
        process.join()


def test_files() -> list[str]:
    files = sorted(path.relative_to(ROOT).as_posix() for path in (ROOT / "tests").rglob("test_*.py"))
    return [file for file in files if file not in runs.LEFT_OUT]


def _name(file: str) -> str:
    return file.replace("/", "_") + ".jsonl"


def _sha(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()[:16]


def _sha_of(kept: Path) -> str:
    if not kept.exists():
        return ""
    with kept.open(encoding="utf-8") as file:
        return str(json.loads(file.readline())["sha"])


def _mark(marked: Path, numbers: Path, modules: list[str] | None) -> None:
    """A copy whose blocks tell when they are run; a block keeps the number that it once had."""
    runs.make_copy(marked)
    number: dict[str, int] = json.loads(numbers.read_text()) if numbers.exists() else {}
    sources = marked / "src" / "cleancli"
    for path in sorted(sources.rglob("*.py")):
        module = path.relative_to(sources).as_posix()
        if modules is None or module in modules:
            text = instrumented(module, path.read_text(encoding="utf-8"), number)
            path.write_text(text, encoding="utf-8")
    shutil.copy2(Path(__file__).with_name("mutation_hits.py"), marked / "src")
    numbers.write_text(json.dumps(number))


def _collect(folder: Path, worker: int, files: list[str]) -> None:
    for place, file in enumerate(files, start=1):
        out = folder / "coverage" / f".{_name(file)}"
        out.write_text(json.dumps({"file": file, "sha": _sha(ROOT / file)}) + "\n", encoding="utf-8")
        work = folder / f"collect-{worker}"
        job = {"out": str(out), "dumps": str(work)}
        ended = runs.run(folder / "marked", [file], job, folder / "kernels", _FILE_SECONDS, work)
        out.rename(folder / "coverage" / _name(file))
        said = (ended.said.strip().splitlines() or [f"exit {ended.code}"])[-1]
        print(f"{worker}: {place} of {len(files)}: {file}: {said}", file=sys.stderr, flush=True)


# ---- asking


class Knowledge:
    """What each test ran, and how long it took."""

    def __init__(self, folder: Path, files: list[str]) -> None:
        number: dict[str, int] = json.loads((folder / "blocks.json").read_text())
        self._blocks: dict[str, set[str]] = defaultdict(set)
        self._functions: dict[str, set[str]] = defaultdict(set)
        self._modules: dict[str, set[str]] = defaultdict(set)
        self._seconds: dict[str, float] = {}
        self._breadth: dict[str, int] = {}
        self._slowest: dict[str, float] = defaultdict(float)
        names = {identity: block for block, identity in number.items()}
        kept = {file: folder / "coverage" / _name(file) for file in files}
        for path in kept.values():
            if path.exists():
                self._read(path, names)
        self._unknown = {f: runs.imported(ROOT / f) for f, path in kept.items() if not path.exists()}
        self._importers = runs.importers()

    def _read(self, path: Path, names: dict[int, str]) -> None:
        for line in path.read_text(encoding="utf-8").splitlines()[1:]:
            seen = json.loads(line)
            if not seen["passed"]:
                continue
            test = seen["test"]
            self._seconds[test], self._breadth[test] = seen["seconds"], len(seen["hits"])
            file = test.split("::")[0]
            self._slowest[file] = max(self._slowest[file], seen["seconds"])
            for identity in seen["hits"]:
                block = names[identity]
                self._blocks[block].add(test)
                self._functions[block.rpartition(":")[0]].add(test)
                self._modules[block.partition(":")[0]].add(test)

    def tests_for(self, change: Change, budget: float, kills: Counter[tuple[str, str]]) -> Chosen:
        """In two stages: a few tests of few files, then all within `budget` seconds."""
        tests = self._running(change)
        tests |= self._perhaps_running(change)

        stated = change.block.endswith(MODULE)

        def rank(test: str) -> tuple[int, int, float]:
            apart = 1.0 if test.split("/")[1] == change.module.split("/")[0] else 2.0
            if test.count("/") == 1:  # of the project as a whole, such as its list of numbers
                apart = 0.25
            cost = self._seconds[test] + 0.002 * self._breadth[test]
            return -kills[change.module, test], -kills[change.kind, test] if stated else 0, apart * cost

        order = sorted(tests, key=rank)
        seconds = self._seconds
        first: list[str] = []
        files: set[str] = set()
        cases: Counter[str] = Counter()
        spent = 0.0
        for test in order:
            file = test.split("::")[0]
            case = test.split("[")[0]
            full = len(files) == _FIRST_FILES and file not in files
            if full or cases[case] == _CASES or spent + seconds[test] > _FIRST_SECONDS:
                continue
            if len(first) == _FIRST_TESTS:
                break
            first.append(test)
            spent += seconds[test]
            files.add(file)
            cases[case] += 1
        rest: list[str] = []
        tried = set(first)
        for test in order:
            if test not in tried and spent + seconds[test] <= budget:
                rest.append(test)
                spent += seconds[test]
        stages = tuple(stage for stage in (tuple(first), _by_file(rest)) if stage)
        return Chosen(stages, len(order) - len(first) - len(rest))

    def limit(self, test: str) -> float:
        """Seconds of the processor after which a test, with what its file makes once, is stuck."""
        made_once = 2 * self._slowest[test.split("::")[0]]
        seconds = self._seconds.get(test, UNKNOWN_SECONDS)  # one of a file that was not looked at yet
        return max(_LEAST_LIMIT, _TIMES_AS_LONG * seconds + made_once)

    def limit_of_all(self, tests: Iterable[str]) -> float:
        """The same for several that run after each other."""
        tests = list(tests)
        made_once = sum(2 * self._slowest[file] for file in {test.split("::")[0] for test in tests})
        return 4 * _LEAST_LIMIT + made_once + _TIMES_AS_LONG * sum(self._seconds[test] for test in tests)

    def _running(self, change: Change) -> set[str]:
        place = change.block.rpartition(":")[0]
        if change.block.endswith(MODULE) or change.compiled:
            near = set(self._modules.get(change.module, ()))  # those that import it among them
            wanted = self._importers.get(change.module, set()) if change.compiled or not near else set()
            return near.union(*(self._modules.get(module, set()) for module in wanted))
        found = self._blocks.get(change.block)
        if found is None and change.block.endswith(":1"):
            found = self._functions.get(place)
        return set(found or ())

    def _perhaps_running(self, change: Change) -> set[str]:
        """Of the test files that were not looked at yet those of the package, and those that import the
        module or what imports it: each as a whole."""
        users = self._importers.get(change.module, set())
        package = change.module.split("/")[0]
        found = set()
        for file, modules in self._unknown.items():
            if change.module in modules or modules & users or file.split("/")[1] == package:
                found.add(file)
                near = 1 if change.module in modules else 4
                self._seconds[file], self._breadth[file] = near * UNKNOWN_SECONDS, 0
        return found


def _by_file(tests: Iterable[str]) -> tuple[str, ...]:
    """Tests of one file after each other, so that what they share is made once; files as their first test."""
    files: dict[str, list[str]] = {}
    for test in tests:
        files.setdefault(test.split("::")[0], []).append(test)
    return tuple(test for group in files.values() for test in group)
