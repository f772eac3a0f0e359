"""Results: they cannot be changed, can be pickled, and are well-formed HTML in which all is escaped."""

from __future__ import annotations

import errno
import json
import os
import pickle
import re
from concurrent.futures import ThreadPoolExecutor
from dataclasses import FrozenInstanceError, fields, replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest

import cleancli
from cleancli.api.run_inputs import inputs_of
from cleancli.api.runs import carry_out, new_run
from cleancli.api.tables import TextTable
from cleancli.execution.setup import EpisodeOptions
from cleancli.planning.evaluation.value import Sampled
from cleancli.resources import shipped

EVIL = '<script>alert("&")</script>\x1b[31m'


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """One of each kind; an observation takes pybullet."""
    given = ("cleaning", "three_areas")
    run = cleancli.execute(*given, seed=5, samples=50, runs=tmp_path_factory.mktemp("runs"))
    found: dict[str, Any] = {
        "plan": cleancli.plan(*given, seed=1, samples=50),
        "explained": cleancli.plan(*given, seed=1, samples=50, explain=True),
        "evaluate": cleancli.evaluate(*given, "moveToContainerFast(a1)", explain=True),
        "simulate": cleancli.simulate(*given, episodes=2, samples=50, planner=["prada", "prada+"]),
        "explain": cleancli.explain(*given, "join2(a1, a2)"),
        "execute": run,
        "learn": cleancli.learn("cleaning", run.folder),
        "domain": cleancli.load_domain("cleaning"),
        "problem": cleancli.load_problem("three_areas", "cleaning"),
    }
    return found


NAMES = ["plan", "explained", "evaluate", "simulate", "explain", "execute", "learn", "domain", "problem"]


@pytest.mark.parametrize("name", NAMES)
def test_shown_in_a_notebook(name: str, results: dict[str, Any]) -> None:
    page = ElementTree.fromstring(results[name]._repr_html_())
    assert "".join(page.itertext()).strip()
    if name not in ("domain", "problem"):
        assert page.find(".//table") is not None


@pytest.mark.parametrize("name", NAMES)
def test_pickled_and_frozen(name: str, results: dict[str, Any]) -> None:
    result = results[name]
    again = pickle.loads(pickle.dumps(result))
    assert again == result
    assert str(again) == str(result)
    assert not hasattr(result, "__dict__")
    with pytest.raises(FrozenInstanceError):
        setattr(result, fields(result)[0].name, "changed")


@pytest.mark.parametrize("name", NAMES[:-2])
def test_plain_dictionaries(name: str, results: dict[str, Any]) -> None:
    data = results[name].to_dict()
    assert json.loads(json.dumps(data)) == data


@pytest.mark.parametrize("name", NAMES)
def test_all_texts_are_escaped(name: str, results: dict[str, Any]) -> None:
    """Every text that a result holds is made evil, one at a time."""
    result = results[name]
    for field in fields(result):
        value = getattr(result, field.name)
        evil: Any = EVIL
        if isinstance(value, tuple) and value and isinstance(value[0], str):
            evil = (EVIL, *value[1:])
        elif not isinstance(value, str) or field.name == "empty_because":
            continue
        html = replace(result, **{field.name: evil})._repr_html_()
        assert "<script" not in html
        assert "\x1b" not in html
        ElementTree.fromstring(html)


def test_tables_escape_and_align() -> None:
    table = TextTable(("name", EVIL), (("a", "1"), (EVIL, "12")))
    page = ElementTree.fromstring(table.html())
    cells = [cell.text for cell in page.iter() if cell.tag in ("th", "td")]
    evil = EVIL.replace("\x1b", "\\x1b")
    assert cells == ["name", evil, "a", "1", evil, "12"]
    lines = str(table).splitlines()
    assert len({len(line) for line in lines[1:]}) == 1
    assert not re.search("[\x00-\x08\x1b]", str(table))


def test_an_observation_is_a_picture() -> None:
    pytest.importorskip("pybullet")
    seen = cleancli.perceive("two_groups")
    assert seen._repr_png_().startswith(b"\x89PNG\r\n")
    assert pickle.loads(pickle.dumps(seen)) == seen
    ElementTree.fromstring(seen._repr_html_())
    assert json.loads(json.dumps(seen.to_dict())) == seen.to_dict()


def test_refusals_are_pickled() -> None:
    with pytest.raises(cleancli.Refused) as refused:
        cleancli.load_domain("domain d { types { spot spot } }")
    again = pickle.loads(pickle.dumps(refused.value))
    assert str(again) == str(refused.value)
    assert again.diagnostics == refused.value.diagnostics


def test_threads_find_what_one_finds(tmp_path: Path) -> None:
    """Plans, and a run outside the main thread, where no signal is to be had."""

    def planned(seed: int) -> tuple[str, ...]:
        return cleancli.plan("cleaning", "three_areas", seed=seed, samples=50, planner="prada").plan

    alone = [planned(seed) for seed in range(6)]
    with ThreadPoolExecutor(4) as threads:
        assert list(threads.map(planned, range(6))) == alone
        run = threads.submit(
            cleancli.execute, "cleaning", "three_areas", seed=5, samples=50, runs=tmp_path
        ).result()
    assert run.clean


def test_an_interrupted_run_goes_on(tmp_path: Path) -> None:
    """Ctrl-C at any event leaves a folder that can be gone on with, to the end that it had come to alone."""
    whole = cleancli.execute("cleaning", "three_areas", seed=5, samples=50, runs=tmp_path)
    seen: list[object] = []

    def stop(event: object) -> None:
        seen.append(event)
        if len(seen) == 7:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt, match="go on with: cleancli execute --resume") as stopped:
        cleancli.execute("cleaning", "three_areas", seed=5, samples=50, runs=tmp_path, on_event=stop)
    folder = stopped.value.folder  # type: ignore[attr-defined]
    assert str(folder) in str(stopped.value)
    resumed = cleancli.resume(folder, on_event=seen.append)
    assert (resumed.actions, resumed.clean, resumed.told) == (whole.actions, whole.clean, whole.told)
    assert resumed.folder == folder
    assert len(seen) > 7


def test_who_asked_for_a_planner_that_there_is_not_is_told(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"^`planner`: 'prado' is not one of .*'prada'"):
        cleancli.plan("cleaning", "three_areas", planner="prado")
    text = shipped("problems").joinpath("three_areas.nid").read_text(encoding="utf-8")
    (tmp_path / "p.nid").write_text(
        text.rstrip().removesuffix("}") + "  planner { name = prado }\n}\n", encoding="utf-8"
    )
    with pytest.raises(ValueError, match=r"^the problem asks for the planner `prado`; there is"):
        cleancli.plan("cleaning", tmp_path / "p.nid")


@pytest.mark.parametrize(
    ("missing", "rows"),
    [
        ({}, [("factored", "1.5000"), ("exact", "1.2500"), ("sampled", "1.2400")]),
        ({"exact": None}, [("factored", "1.5000"), ("exact", "-"), ("sampled", "1.2400")]),
        ({"exact": None, "sampled": None}, [("factored", "1.5000")]),  # as libPRADA computes
    ],
)
def test_each_way_to_value_a_sequence_has_a_row(
    missing: dict[str, None], rows: list[tuple[str, str]], results: dict[str, Any]
) -> None:
    """Where too many states may occur for the exact value, the table says so."""
    values: dict[str, Any] = {"factored": 1.5, "exact": 1.25, "sampled": Sampled(1.24, 0.01, 700)}
    found = replace(results["evaluate"], **{**values, **missing})
    assert [row[:2] for row in found.table().rows] == rows
    assert ("too many states may occur" in str(found)) == (("exact", "-") in rows)
    assert ("± 0.0100 (standard error), 700 runs" in str(found)) == (len(rows) == 3)


def test_a_record_that_cannot_be_written_is_told_with_how_to_go_on(tmp_path: Path) -> None:
    """The tool is raised, and the run can go on from its folder when there is room again."""
    seen: list[object] = []
    stopped: list[str] = []

    def full(event: object) -> None:
        seen.append(event)
        if len(seen) == 7:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    given = cleancli.load_problem("three_areas", "cleaning")
    inputs = inputs_of(given, EpisodeOptions(samples=50), seed=5, objective=None, job=None)
    with new_run(inputs, tmp_path, video=False) as begun:
        run = replace(begun, session=replace(begun.session, stop=lambda: stopped.append("raised")))
        with pytest.raises(OSError, match="No space") as failed:
            carry_out(run, full)
    assert stopped == ["raised"]
    assert failed.value.__notes__ == [f"go on later with `cleancli execute --resume {begun.folder}`"]
    assert cleancli.resume(begun.folder).clean


@pytest.mark.parametrize(
    ("truth", "told"),
    [
        ({}, ["10 of 10 particles in the container, 0 on the table, 0 on the floor"]),
        (
            {"in_container": 8, "on_table": 1, "on_floor": 1, "left_on_table_at": [[0.1, -0.2]]},
            [
                "8 of 10 particles in the container, 1 on the table, 1 on the floor",
                "left on the table at (m): [[0.1, -0.2]]",
            ],
        ),
        ({"in_container": 7, "in_dustpan": 3}, ["7 of 10", "on the floor, 3 in the dustpan"]),
        ({"ink_left": 0.25, "particles": 0}, ["truly: 25.0% of the ink left"]),
    ],
)
def test_a_run_tells_where_the_dirt_truly_is(
    truth: dict[str, object], told: list[str], results: dict[str, Any]
) -> None:
    nowhere: dict[str, object] = {
        "on_table": 0,
        "in_dustpan": 0,
        "on_floor": 0,
        "ink_left": None,
        "left_on_table_at": [],
    }
    run = replace(results["execute"], truth={"particles": 10, "in_container": 10, **nowhere, **truth})
    said = [line for line in str(run).splitlines() if line.startswith(("truly", "left"))]
    assert len(said) == 1 + bool(run.truth["on_table"])
    assert all(words in "\n".join(said) for words in told)
