"""The table of what a study may say is what the checker takes, what other modules know, and what the
documentation says."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from cleancli.execution.setup import MOST, Job, usual_strategy
from cleancli.execution.strategies import STRATEGIES
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.learning.estimate import ESTIMATORS
from cleancli.learning.method import MATCHES
from cleancli.learning.optimism import OPTIMISM
from cleancli.planning.registry import PLANNERS
from cleancli.scene.schema import NEEDED, TOP
from cleancli.study import schema
from cleancli.study.check import load_study
from cleancli.study.kinds import Option, spelled
from cleancli.study.row import CLEAN, FINISHED, MEASURES, meaning_of
from cleancli.study.schema import AXES, COMPARED, INNER, OF_ROWS, OWN, keys_of

PAGE = Path(__file__).parents[2] / "docs" / "experiments.md"
PLACES = (TOP, "quick", "part", "compare", "first", "second")
SETTINGS = [(place, key) for place in PLACES for key in keys_of(place)]


def study(place: str, body: str) -> str:
    inside = {
        TOP: body,
        "part": f"part one {{ {body} }}",
        "compare": f"compare one {{ {body} }}",
        "quick": f"quick {{ {body} }}",
    }
    return f"study s {{ {inside.get(place) or f'compare one {{ {place} {{ {body} }} }}'} }}"


def codes(text: str) -> set[str]:
    try:
        load_study(Source("s.nid", text))
    except Refused as refused:
        return {diagnostic.code for diagnostic in refused.diagnostics}
    return set()


def options(key: str) -> tuple[str, ...]:
    kind = AXES[key].kind
    assert isinstance(kind, Option)
    return kind.names


def test_names_are_those_of_the_modules_that_have_them() -> None:
    assert options("strategy") == tuple(STRATEGIES)
    assert (usual_strategy(is_scene=True), usual_strategy(is_scene=False)) == schema.USUAL_STRATEGIES
    assert options("planner") == tuple(PLANNERS)
    assert options("estimator") == (schema.NOTHING, *ESTIMATORS)
    assert options("match") == tuple(MATCHES)
    assert options("optimism") == tuple(OPTIMISM)
    assert options("job") == tuple(job.value for job in Job)
    assert schema.MOST == MOST


def test_every_spelling_is_a_name_and_stands_for_one() -> None:
    for key, known in AXES.items():
        if isinstance(known.kind, Option):
            words = list(map(spelled, known.kind.names))
            assert len(set(words)) == len(words), key
            assert all(re.fullmatch(r"[a-z_][a-z_0-9]*", word) for word in words)


@pytest.mark.parametrize(("place", "key"), SETTINGS)
def test_the_checker_knows_every_key(place: str, key: str) -> None:
    assert "E502" not in codes(study(place, f"{key} = 1 deg"))
    assert "E502" in codes(study(place, f"{key}x = 1 deg"))


@pytest.mark.parametrize(("place", "key"), SETTINGS)
def test_what_is_offered_is_taken(place: str, key: str) -> None:
    for value in keys_of(place)[key].values:
        assert not {"E503", "E504", "E505", "E506"} & codes(study(place, f"{key} = {value}"))


@pytest.mark.parametrize("place", PLACES)
def test_a_section_holds_those_that_the_table_says(place: str) -> None:
    for inner in INNER[place]:
        title = " one" if inner in ("part", "compare") else ""
        assert "E501" not in codes(study(place, f"{inner}{title} {{ }}"))
    assert "E501" in codes(study(place, "dirt { }"))


def test_defaults_read_as_themselves() -> None:
    for key, known in {**OWN, **AXES, **COMPARED}.items():
        if known.default not in (None, NEEDED):
            place = "compare" if key in COMPARED else TOP
            assert codes(study(place, f"{key} = {known.kind.write(known.default)}")) <= {
                "E513",
                "E522",
                "E521",
            }


def test_the_page_tells_every_key_its_values_and_what_it_is_unless_said() -> None:
    text = PAGE.read_text(encoding="utf-8")
    rows = re.findall(r"^\| `(\w+)` \| (.+) \|$", text, re.M)
    for table in (OWN, AXES, OF_ROWS, COMPARED):
        for key, known in table.items():
            row = next(told for name, told in rows if name == key and known.meaning in told)
            for value in known.values:
                assert known.example or f"`{value}`" in row, f"{key} = {value}"
            if known.default not in (None, NEEDED, ""):
                assert f"| `{known.kind.write(known.default)}`" in row, key


def test_the_page_tells_of_each_measure_what_it_means_and_which_worlds_have_it() -> None:
    text = PAGE.read_text(encoding="utf-8")
    table = text[text.index("| measure | what it means | of |") :].partition("\n\n")[0]
    rows = re.findall(r"^\| `(\w+)` \| (.+) \| (.+) \|$", table, re.M)
    worlds = {
        (True, False): "tables",
        (False, True): "problems",
        (False, False): "tables and problems",
    }
    told = {"clean": f"{meaning_of('clean', CLEAN)} (of problems: that {FINISHED.ended})"}
    assert rows == [
        (name, told.get(name, each.meaning), worlds[each.of_tables, each.of_problems])
        for name, each in MEASURES.items()
    ]
