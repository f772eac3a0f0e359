"""Names, paths, texts and what is loaded mean the same; what cannot be used is refused, each kind by its
exception."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import cleancli

ROOT = Path(__file__).parents[2]
DOMAIN = ROOT / "domains" / "cleaning.nid"
PROBLEM = ROOT / "problems" / "three_areas.nid"
ASKED: Any = {"seed": 1, "samples": 50, "planner": "prada"}


def test_names_paths_texts_and_loaded_mean_the_same(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    shutil.copy(DOMAIN, "mine.nid")
    domain = cleancli.load_domain(DOMAIN)
    domains: list[Any] = ["cleaning", DOMAIN, "mine.nid", DOMAIN.read_text(encoding="utf-8"), domain]
    problems: list[Any] = ["three_areas", str(PROBLEM), PROBLEM.read_text(encoding="utf-8")]
    problems.append(cleancli.load_problem("three_areas", domain))
    plans = {cleancli.plan(each, "three_areas", **ASKED).plan for each in domains}
    plans |= {cleancli.plan(domain, each, **ASKED).plan for each in problems}
    plans.add(cleancli.plan("cleaning", problems[-1], **ASKED).plan)
    assert len(plans) == 1
    assert next(iter(plans))


def test_a_path_with_a_brace_is_given_as_a_path(tmp_path: Path) -> None:
    path = tmp_path / "a{b}.nid"
    shutil.copy(DOMAIN, path)
    assert cleancli.load_domain(path).name == "cleaning"


def test_what_is_loaded_prints_as_its_text() -> None:
    problem = cleancli.load_problem("two_groups", "cleaning")
    assert problem.is_scene
    assert str(problem) == (ROOT / "problems" / "two_groups.nid").read_text(encoding="utf-8")
    assert str(problem.domain) == DOMAIN.read_text(encoding="utf-8")


def test_a_problem_is_checked_again_for_another_domain(tmp_path: Path) -> None:
    problem = cleancli.load_problem("three_areas", "cleaning")
    renamed = DOMAIN.read_text(encoding="utf-8").replace("scattered", "spread")
    with pytest.raises(cleancli.Refused, match=r"E203.*scattered"):
        cleancli.load_problem(problem, renamed)


def test_includes_from_outside_are_asked_for(tmp_path: Path) -> None:
    text = DOMAIN.read_text(encoding="utf-8")
    (tmp_path / "inner").mkdir()
    (tmp_path / "outer.nid").write_text(text, encoding="utf-8")
    including = tmp_path / "inner" / "own.nid"
    including.write_text('domain own {\n  include "../outer.nid"\n}\n', encoding="utf-8")
    with pytest.raises(cleancli.Refused, match="outside"):
        cleancli.load_domain(including)
    assert len(cleancli.load_domain(including, include_outside=True).sources) == 2


@pytest.mark.parametrize(
    ("wrong", "code", "place"),
    [
        ("nowhere", "E001", "no file `nowhere`"),
        ("problem p { domain = cleaning  init { dirtt(a1) } }", "E203", "<problem>:1:"),
        ("problem p { domain = cleaning", "E1", "<problem>:1:"),
    ],
)
def test_mistakes_of_texts_are_located(wrong: str, code: str, place: str) -> None:
    for function in (cleancli.plan, cleancli.simulate, cleancli.execute):
        with pytest.raises(cleancli.Refused) as refused:
            function("cleaning", wrong)
        assert any(mistake.code.startswith(code) for mistake in refused.value.diagnostics)
        assert place in str(refused.value)


def test_a_refusal_reads_as_check_prints_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    from cleancli.cli.main import run

    path = tmp_path / "bad.nid"
    path.write_text("domain d { types { spot }\n  actions { wipe(?s - spott) } }\n", encoding="utf-8")
    with pytest.raises(cleancli.Refused) as refused:
        cleancli.load_domain(path)
    run(["check", str(path)])
    shown = capsys.readouterr()
    assert str(refused.value) in shown.out + shown.err


def test_actions_that_do_not_exist_are_refused() -> None:
    for function in (cleancli.evaluate, cleancli.explain):
        with pytest.raises(cleancli.Refused, match="E206"):
            function("cleaning", "three_areas", "wipe(a1)")


def test_experience_that_is_none_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "experience.jsonl"
    path.write_text("{}\n", encoding="utf-8")
    with pytest.raises(cleancli.Refused, match="E701"):
        cleancli.learn("cleaning", path)
    with pytest.raises(cleancli.Refused, match=r"E001.*nowhere"):
        cleancli.learn("cleaning", "nowhere.jsonl")
    with pytest.raises(ValueError, match="name experience"):
        cleancli.learn("cleaning")


@pytest.mark.parametrize("loaded", [False, True])
def test_a_shipped_domain_is_not_written_to(loaded: bool, tmp_path: Path) -> None:
    path = tmp_path / "experience.jsonl"
    path.write_text("", encoding="utf-8")
    before = DOMAIN.read_bytes()
    for domain in ("cleaning", DOMAIN.read_text(encoding="utf-8")):
        given: Any = cleancli.load_domain(domain) if loaded else domain
        with pytest.raises(ValueError, match="ships with cleancli or is a text"):
            cleancli.learn(given, path, write=True)
        with pytest.raises(ValueError, match="ships with cleancli or is a text"):
            cleancli.learn(given, path).write()
    assert DOMAIN.read_bytes() == before


@pytest.mark.parametrize(
    ("name", "wrong", "message"),
    [
        ("plan", {"planner": "best"}, "'best' is not one of 'prada+', 'prada'"),
        ("plan", {"samples": 0}, "0 is not in the range x>=1"),
        ("plan", {"samples": 2.5}, "2.5 is not a valid integer"),
        ("plan", {"seed": -1}, "-1 is not in the range x>=0"),
        ("plan", {"seed": True}, "True is not a valid integer"),
        ("plan", {"threads": 0}, "0 is not in the range x>=1"),
        ("plan", {"time_limit": 0}, "0 is not in the range x>0"),
        ("plan", {"time_limit": "long"}, "'long' is not a valid float"),
        ("plan", {"time_limit": float("nan")}, "nan is not a valid float"),
        ("plan", {"objective": "money"}, "'money' is not one of 'reward', 'time'"),
        ("plan", {"options": {"margn": 1}}, "unknown option `margn`"),
        ("plan", {"options": {"margin": "much"}}, "`margin` wants a number, not `much`"),
        ("plan", {"planner": "sst", "options": {"depth": 1.5}}, "`depth` wants a whole number, not `1.5`"),
        ("plan", {"options": {"seed": 1}}, "`seed` has an option of its own"),
        ("simulate", {"episodes": 0}, "0 is not in the range x>=1"),
        ("simulate", {"planner": ["prada", "best"]}, "'best' is not one of"),
        ("simulate", {"max_actions": -1}, "-1 is not in the range x>=0"),
        ("execute", {"strategy": "luck"}, "'luck' is not one of"),
        ("execute", {"strategy": "reactive"}, "goes by places, which only a scene has"),
        ("execute", {"strategy": "wipe"}, "goes by places, which only a scene has"),
        ("execute", {"strategy": "tsp"}, "goes by places, which only a scene has"),
        ("execute", {"job": "broom"}, "'broom' is not one of 'container', 'dustpan'"),
        ("execute", {"samples": 10**10}, "10000000000 is not in the range 1<=x<=1000000000"),
        ("execute", {"max_seconds": float("inf")}, "inf is not in the range 0<=x<=1000000000"),
    ],
)
def test_options_that_make_no_sense(
    name: str, wrong: dict[str, object], message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ValueError) as error:  # noqa: PT011  # the message is compared below
        getattr(cleancli, name)("cleaning", "three_areas", **wrong)
    assert message in str(error.value)
    assert type(error.value).__module__.startswith("cleancli."), "no exception of a library"
    assert not list(tmp_path.rglob("*.json"))


def test_what_cannot_be_planned_is_refused_at_its_place() -> None:
    with pytest.raises(cleancli.Refused, match=r"three_areas.nid:\d+:\d+: error\[E903\]"):
        cleancli.plan("cleaning", "three_areas", planner="exact", options={"states": 1})


def test_runs_that_cannot_go_on(tmp_path: Path) -> None:
    with pytest.raises(cleancli.Refused, match="E705"):
        cleancli.resume(tmp_path)
    run = cleancli.execute("cleaning", "three_areas", seed=5, samples=50, runs=tmp_path)
    with pytest.raises(ValueError, match="has ended"):
        cleancli.resume(run.folder)


def test_without_pybullet_all_works_but_tables(tmp_path: Path) -> None:
    code = """
import sys
sys.modules["pybullet"] = None
import cleancli
assert cleancli.plan("cleaning", "three_areas", samples=50).plan
assert cleancli.execute("cleaning", "three_areas", samples=50, seed=5, max_actions=1).actions == 1
for function in (cleancli.perceive, lambda scene: cleancli.execute("cleaning", scene)):
    try:
        function("two_groups")
    except ImportError as missing:
        assert "pip install" in str(missing)
    else:
        raise AssertionError
"""
    subprocess.run([sys.executable, "-c", code], check=True, cwd=tmp_path)
