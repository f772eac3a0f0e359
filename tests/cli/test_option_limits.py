"""Options of planners against the table of docs/commands.md: whose they are, defaults, least and most."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

from cleancli.language.model import Problem
from cleancli.planning.choice import named_options, planner_options, with_named
from cleancli.planning.plan import BadOption, Options
from cleancli.planning.registry import PLANNERS

PAGE = (Path(__file__).parents[2] / "docs" / "commands.md").read_text(encoding="utf-8")
PROBLEM = Problem("p", "d", (), frozenset())
TABLE = PAGE.partition("| named option |")[2].partition("\n\n")[0]


def owners(told: str) -> tuple[str, ...]:
    """The planners that a cell of the table names."""
    if told.startswith("all:"):
        return tuple(PLANNERS)
    return tuple(name for name in PLANNERS if re.search(rf"(?<![\w-]){re.escape(name)}[,:]", told))


ROWS = {
    name: (usual, least, most, owners(told))
    for name, usual, least, most, told in re.findall(
        r"^\| `(\w+)` \| ([\w.-]+) \| ([\w.-]+), ([\w.-]+) \| (.*) \|$", TABLE, re.M
    )
}
PAIRS = [(name, planner) for name, row in ROWS.items() for planner in row[3]]
NUMBERS = [pair for pair in PAIRS if ROWS[pair[0]][1].replace(".", "").replace("e-", "").isdigit()]


def asked(name: str, planner: str, *values: str) -> Any:
    """What a planner is asked for where these values are written, one after the other."""
    (chosen,), options = with_named([planner], Options(), [f"{name}={value}" for value in values])
    return getattr(options if hasattr(options, name) else chosen.own, name)


def test_the_table_lists_what_can_be_asked_for() -> None:
    everyones = set(named_options(Options()))
    for planner in PLANNERS.values():
        assert {name for name, row in ROWS.items() if planner.name in row[3]} == {
            *everyones,
            *named_options(planner.own),
        }


def test_the_pages_tell_of_every_planner() -> None:
    """In the tables of planners, of what they prefer among equals, and of options; beliefs have a section."""
    folder = Path(__file__).parents[2] / "docs"
    page = "".join((folder / name).read_text(encoding="utf-8") for name in ("planning.md", "planners.md"))
    heads = ("| of equals |", "| planner | what it finds |", "| planner | options |")
    equals, chosen, options = (page.partition(head)[2].partition("\n\n")[0] for head in heads)
    assert all(f"`{name}`" in equals and f"`{name}`" in chosen for name in PLANNERS)
    assert all(f"`{name}`" in options for name in PLANNERS if "prada" not in name)


def test_an_option_of_one_planner_is_none_of_all() -> None:
    everyones = set(Options.__dataclass_fields__)
    assert not any(everyones & set(named_options(planner.own)) for planner in PLANNERS.values())


@pytest.mark.parametrize(("name", "planner"), PAIRS)
def test_what_is_left_out_is_as_documented(name: str, planner: str) -> None:
    usual = asked(name, planner)
    assert str(usual) == ROWS[name][0] or float(usual) == float(ROWS[name][0])


@pytest.mark.parametrize(("name", "planner"), NUMBERS)
def test_limits_can_be_asked_for_and_no_more(name: str, planner: str) -> None:
    _, least, most, _ = ROWS[name]
    whole = isinstance(asked(name, planner), int)
    assert asked(name, planner, least) == float(least)
    with pytest.raises(BadOption):
        asked(name, planner, str(int(least) - 1) if whole else "-0.001")
    if most == "any":
        assert asked(name, planner, "1000000000") == 1e9
        return
    assert asked(name, planner, most) == float(most)
    with pytest.raises(BadOption):
        asked(name, planner, str(int(most) + 1) if whole else str(float(most) + 0.001))


@pytest.mark.parametrize("name", ROWS)
def test_an_option_is_refused_where_no_planner_has_it(name: str) -> None:
    _, least, _, having = ROWS[name]
    others = [planner for planner in PLANNERS if planner not in having]
    for planner in others:
        with pytest.raises(BadOption, match=f"is an option of .*{re.escape(having[0])}.*, not of {planner}"):
            asked(name, planner, least)
    if others:
        with pytest.raises(BadOption, match="given sequence"):
            with_named((), Options(), [f"{name}={least}"])
        both, _ = with_named([others[0], having[0]], Options(), [f"{name}={least}"])
        assert both[0] == PLANNERS[others[0]]
        assert getattr(both[1].own, name) == asked(name, having[0], least)


@pytest.mark.parametrize(
    "wrong", ["margin", "margin=", "margin=much", "depth=1.5", "arithmetic=real", "deep=1"]
)
def test_what_is_no_value_of_an_option_is_refused(wrong: str) -> None:
    with pytest.raises(BadOption):
        with_named(tuple(PLANNERS), Options(), [wrong])


def test_words_are_taken_as_they_are() -> None:
    words = ROWS["arithmetic"][1:3]
    assert tuple(asked("arithmetic", "exact", word) for word in words) == words


def test_of_two_values_the_last_holds() -> None:
    assert asked("states", "exact", "5", "7") == 7


def test_the_command_line_is_asked_before_the_problem_and_that_before_the_usual() -> None:
    problem = Problem("p", "d", (), frozenset(), samples=7, seed=0)
    assert (planner_options(problem).samples, planner_options(problem).seed) == (7, 0)
    given = planner_options(problem, samples=9, seed=4, threads=1, time_limit=0.5, compat=True)
    assert (given.samples, given.seed, given.threads, given.time_limit, given.compat) == (9, 4, 1, 0.5, True)
    usual = planner_options(PROBLEM)
    assert (usual.samples, usual.seed, usual.threads) == (Options().samples, 1, Options().threads)
