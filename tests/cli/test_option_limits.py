"""Options of planners against the table of docs/commands.md: their defaults, their least and their most."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from cleancli.language.model import Problem
from cleancli.planning.choice import ALLOWED, planner_options
from cleancli.planning.plan import BadOption, Options

PAGE = (Path(__file__).parents[2] / "docs" / "commands.md").read_text(encoding="utf-8")
PROBLEM = Problem("p", "d", (), frozenset())
ROWS = {
    name: (default, least, most)
    for name, default, least, most in re.findall(
        r"^\| `(\w+)` \| ([\w.]+) \| ([\w.]+), ([\w.]+) \|", PAGE, re.M
    )
    if hasattr(Options(), name)
}


def asked(name: str, value: str) -> object:
    return getattr(planner_options(PROBLEM, named=[f"{name}={value}"]), name)


def test_the_table_lists_what_can_be_asked_for() -> None:
    assert set(ROWS) == set(ALLOWED)


@pytest.mark.parametrize("name", ROWS)
def test_what_is_left_out_is_as_documented(name: str) -> None:
    usual = getattr(planner_options(PROBLEM), name)
    assert str(usual) == ROWS[name][0] or float(usual) == float(ROWS[name][0])


@pytest.mark.parametrize("name", [name for name, row in ROWS.items() if row[1].replace(".", "").isdigit()])
def test_limits_can_be_asked_for_and_no_more(name: str) -> None:
    _, least, most = ROWS[name]
    whole = isinstance(getattr(Options(), name), int)
    assert asked(name, least) == float(least)
    with pytest.raises(BadOption):
        asked(name, str(int(least) - 1) if whole else "-0.001")
    if most == "any":
        assert asked(name, "1000000000") == 1e9
        return
    assert asked(name, most) == float(most)
    with pytest.raises(BadOption):
        asked(name, str(int(most) + 1) if whole else "1.001")


@pytest.mark.parametrize(
    "wrong", ["margin", "margin=", "margin=much", "depth=1.5", "arithmetic=real", "deep=1"]
)
def test_what_is_no_value_of_an_option_is_refused(wrong: str) -> None:
    with pytest.raises(BadOption):
        planner_options(PROBLEM, named=[wrong])


def test_words_are_taken_as_they_are() -> None:
    _, *words = ROWS["arithmetic"]
    assert [asked("arithmetic", word) for word in words] == words


def test_the_command_line_is_asked_before_the_problem_and_that_before_the_usual() -> None:
    problem = Problem("p", "d", (), frozenset(), samples=7, seed=0)
    assert (planner_options(problem).samples, planner_options(problem).seed) == (7, 0)
    given = planner_options(problem, samples=9, seed=4, threads=1, time_limit=0.5, compat=True)
    assert (given.samples, given.seed, given.threads, given.time_limit, given.compat) == (9, 4, 1, 0.5, True)
    usual = planner_options(PROBLEM)
    assert (usual.samples, usual.seed, usual.threads) == (Options().samples, 1, Options().threads)
