"""benchmarks/mutation.py: what it changes and leaves alone, which tests it finds, and that it goes on."""

from __future__ import annotations

import contextlib
import importlib
import json
import os
import random
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

ROOT = Path(__file__).parent.parent
TEXT = '''"""A module."""
from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

LIMIT: int = 7
Words = tuple[str, ...]


@dataclass(frozen=True)
class Shelf:
    """A shelf."""

    size: int = 3

    def fits(self, things: Sequence[int], spare: int = 0) -> bool:
        """Whether they fit."""
        assert spare >= 0
        if not things:
            return True
        total = 0
        for thing in things:
            if thing < 0 and spare:
                raise ValueError(f"{thing} is no size")
            total += thing
        return max(total, spare) <= self.size and isinstance(spare, int)


@njit(cache=True)
def kernel(a, b):
    while a < b:
        a += 1
    return a
'''


@pytest.fixture
def load(monkeypatch: pytest.MonkeyPatch) -> Any:
    """Modules of the benchmark."""
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks"))
    return importlib.import_module


@pytest.fixture
def mutants(load: Any) -> ModuleType:
    found: ModuleType = load("mutants")
    return found


def changed(mutants: ModuleType) -> list[Any]:
    found = (mutants.changed(site, TEXT) for site in mutants.sites("shelf.py", TEXT))
    return [change for change in found if change is not None]


def test_each_kind_of_change_is_made_where_it_can_be(mutants: ModuleType) -> None:
    found = {(change.kind, change.before, change.after) for change in changed(mutants)}
    assert {
        ("comparison", "thing < 0", "thing <= 0"),
        ("comparison", "thing < 0", "thing >= 0"),
        ("and, or", "thing < 0 and spare", "thing < 0 or spare"),
        ("dropped part", "thing < 0 and spare", "spare"),
        ("dropped sign", "not things", "things"),
        ("condition always true", "not things", "True"),
        ("dropped statement", "raise ValueError(f'{thing} is no size')", "pass"),
        ("other operator", "total += thing", "total -= thing"),
        ("other function", "max(total, spare)", "min(total, spare)"),
        ("swapped arguments", "isinstance(spare, int)", "isinstance(int, spare)"),
        ("constant", "3", "4"),
        ("constant", "7", "6"),
        ("constant", "True", "False"),
        ("comparison", "a < b", "a <= b"),
    } <= found
    assert ("swapped arguments", "max(total, spare)", "max(spare, total)") not in found, "that is the same"


def test_every_change_differs_from_the_text_in_one_place_and_keeps_its_lines(mutants: ModuleType) -> None:
    found = changed(mutants)
    assert len({change.key for change in found}) > 30
    for change in found:
        compile(change.text, "shelf.py", "exec")
        lines = [change.text.splitlines(), TEXT.splitlines()]
        assert len(lines[0]) == len(lines[1])
        assert sum(new != old for new, old in zip(*lines, strict=True)) == 1


def test_types_assertions_and_what_the_checker_reads_are_left_alone(mutants: ModuleType) -> None:
    lines = {change.line for change in changed(mutants)}
    for number, line in enumerate(TEXT.splitlines(), start=1):
        if line.strip().startswith(("assert", "@", "class", "from", "Words", '"""', "if TYPE_CHECKING")):
            assert number not in lines, line


def test_a_marked_module_does_the_same_and_tells_what_it_ran(
    mutants: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    number: dict[str, int] = {}
    marked = mutants.instrumented("shelf.py", TEXT.replace("@njit(cache=True)", ""), number)
    hits: list[int] = []
    monkeypatch.setitem(sys.modules, "mutation_hits", ModuleType("mutation_hits"))
    sys.modules["mutation_hits"].hit = hits.append  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "shelf", ModuleType("shelf"))
    space = sys.modules["shelf"].__dict__
    exec(compile(marked, "shelf.py", "exec"), space)
    names = {identity: block for block, identity in number.items()}
    ran = []
    for things in ([], [1, 1], [2, 2]):
        hits.clear()
        space["Shelf"]().fits(things)
        ran.append([names[hit] for hit in hits])
    start = "shelf.py:Shelf.fits:"
    assert ran[0][-1] != ran[1][-1]
    assert ran[1] == ran[2]
    assert all(name.startswith(start) for name in ran[1])
    blocks = {change.block for change in changed(mutants)}
    assert {name for run in ran for name in run} <= blocks | set(number)


def test_machine_code_is_not_marked_and_known_as_such(mutants: ModuleType) -> None:
    number: dict[str, int] = {}
    mutants.instrumented("shelf.py", TEXT, number)
    assert not [block for block in number if "kernel" in block]
    assert {change.compiled for change in changed(mutants) if "a < b" in change.before} == {True}


def test_what_another_module_compiles_is_not_marked(mutants: ModuleType) -> None:
    module = "planning/preference.py"
    marked = mutants.instrumented(module, (ROOT / "src/cleancli" / module).read_text(), {})
    assert marked.count("_hit_(") == 1, "only the module itself says that it was run"


def test_tests_are_chosen_by_what_they_run_the_quickest_first(load: Any, tmp_path: Path) -> None:
    tests = load("mutation_tests")
    (tmp_path / "coverage").mkdir()
    (tmp_path / "blocks.json").write_text(json.dumps({"m/a.py:f:1": 0, "m/a.py:f:2": 1, "m/b.py:g:1": 2}))
    lines = [
        {"file": "tests/m/test_a.py", "sha": ""},
        {"test": "tests/m/test_a.py::slow", "seconds": 3.0, "passed": True, "hits": [0, 1]},
        {"test": "tests/m/test_a.py::quick", "seconds": 0.1, "passed": True, "hits": [1]},
        {"test": "tests/m/test_a.py::failed", "seconds": 0.1, "passed": False, "hits": [1]},
        {"test": "tests/m/test_a.py::other", "seconds": 0.1, "passed": True, "hits": [2]},
        {"test": "tests/m/test_a.py::endless", "seconds": 500.0, "passed": True, "hits": [1]},
    ]
    path = tmp_path / "coverage" / "tests_m_test_a.py.jsonl"
    path.write_text("".join(json.dumps(line) + "\n" for line in lines))
    known = tests.Knowledge(tmp_path, ["tests/m/test_a.py"])
    change = load("mutants").Change("m/a.py", 1, "m/a.py:f:2", False, "constant", "1", "2", "")
    chosen = known.tests_for(change, 60.0, Counter())
    names = [test.partition("::")[2] for stage in chosen.stages for test in stage]
    assert names == ["quick", "slow"]
    assert chosen.left_out == 1
    killed = Counter({("m/a.py", "tests/m/test_a.py::slow"): 1})
    first = next(iter(known.tests_for(change, 60.0, killed).stages[0]))
    assert first.endswith("slow"), "what noticed a change of the module before"
    assert known.limit("tests/m/test_unknown.py::test") >= tests.UNKNOWN_SECONDS


def test_a_test_that_fails_without_the_change_says_nothing_of_it(
    load: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    mutation = load("mutation")
    monkeypatch.setattr(mutation.runs, "make_copy", lambda copy: None)
    monkeypatch.setattr(mutation.runs, "applied", lambda *given: contextlib.nullcontext("changed"))
    bench = mutation.Bench(tmp_path, 0, None, 60.0, 1, types=False)
    failing = {"changed": ("b", "d"), tmp_path / "kernels": ("b",)}
    asked: list[tuple[str, ...]] = []

    def fails(tests: tuple[str, ...], kernels: object) -> str:
        asked.append(tests)
        return next((test for test in tests if test in failing[kernels]), "")

    monkeypatch.setattr(bench, "_failing", fails)
    assert bench._noticing(("a", "b", "c", "d", "e"), None) == "d"
    assert asked == [("a", "b", "c", "d", "e"), ("b",), ("c", "d", "e"), ("d",)]
    assert bench._noticing(("b", "e"), None) == ""
    assert asked[-1] == ("e",), "it is not asked again"


def test_what_types_refuse_is_noticed_unless_they_refuse_all(
    load: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    mutation = load("mutation")
    place = {"changed": False, "sound": True}

    @contextlib.contextmanager
    def applied(*given: object) -> Iterator[None]:
        place["changed"] = True
        yield
        place["changed"] = False

    monkeypatch.setattr(mutation.runs, "make_copy", lambda copy: None)
    monkeypatch.setattr(mutation.runs, "applied", applied)
    monkeypatch.setattr(mutation.runs, "well_typed", lambda copy: place["sound"] and not place["changed"])
    assert mutation.Bench(tmp_path, 0, None, 60.0, 1, types=True)._is_refused_by_type(None)
    place["sound"] = False
    assert not mutation.Bench(tmp_path, 0, None, 60.0, 1, types=True)._is_refused_by_type(None)


def test_reviewed_changes_have_a_reason(load: Any, tmp_path: Path) -> None:
    mutation = load("mutation")
    path = tmp_path / "equal.txt"
    path.write_text("# same bytes\na.py:f:1 | constant | 1 | 2\n\n# other\nb | c | d | e\nf | g | h | i\n")
    assert mutation.reviewed(path) == {
        "a.py:f:1 | constant | 1 | 2": "same bytes",
        "b | c | d | e": "other",
        "f | g | h | i": "other",
    }
    assert all(reason for reason in mutation.reviewed(mutation.EQUAL).values())
    assert mutation.reviewed(tmp_path / "none") == {}


def test_changed_modules_come_first_then_those_tried_longest_ago(load: Any) -> None:
    mutation = load("mutation")
    names = list(mutation.modules())
    sums = {name: mutation.sha(path) for name, path in mutation.modules().items()}

    def result(name: str, at: float, sha: str) -> Any:
        return mutation.Result("", name, sha, 1, 1, "noticed", "", 1, 0, 1.0, at)

    tried = [result(name, 1.0 + place, sums[name]) for place, name in enumerate(names)]
    tried[5] = result(names[5], 5.0, "another")
    order = mutation.in_turn(tried, random.Random(1))
    assert [next(order) for _ in range(4)] == [names[5], *names[:3]]
    del tried[7]
    order = mutation.in_turn(tried, random.Random(1))
    assert [next(order) for _ in range(3)] == [names[5], names[7], names[0]]


def test_what_is_drawn_of_a_module_depends_on_no_other(load: Any) -> None:
    mutation = load("mutation")
    names = ["planning/plan.py", "planning/planners/exact.py", "language/record.py"]
    together = mutation.draw(iter(names * 9), 12, 5)
    alone = mutation.draw(iter(names[1:2] * 9), 4, 5)
    assert len(together) == 12
    assert [change.key for change in together if change.module == names[1]][:4] == [c.key for c in alone]
    other = mutation.draw(iter(names[1:2] * 9), 4, 6)
    assert [change.key for change in other] != [change.key for change in alone]


def test_a_quick_run_notices_and_goes_on_where_it_stopped(tmp_path: Path) -> None:
    command = [sys.executable, str(ROOT / "benchmarks" / "mutation.py"), "--quick", "--keep", str(tmp_path)]
    before = (ROOT / "src" / "cleancli" / "language" / "record.py").read_bytes()

    def run() -> subprocess.CompletedProcess[str]:
        environment = os.environ | {"PYTHONPATH": str(ROOT / "src")}
        return subprocess.run(command, env=environment, capture_output=True, text=True, cwd=tmp_path)

    first = run()
    assert first.returncode == 0, first.stderr
    assert "2 changes tried: 2 noticed, 0 make no difference, 0 not noticed" in first.stdout
    assert first.stderr.count("language/record.py:") == 2
    again = run()
    assert (again.stdout, again.stderr) == (first.stdout, "")
    results = tmp_path / "results.jsonl"
    whole = results.read_text().splitlines(keepends=True)
    results.write_text(whole[0] + whole[1][:20])
    mended = run()
    assert mended.stdout == first.stdout
    assert mended.stderr.count("language/record.py:") == 1
    assert (ROOT / "src" / "cleancli" / "language" / "record.py").read_bytes() == before
