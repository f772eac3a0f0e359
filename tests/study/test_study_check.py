"""What a study means: the product of its axes, part by part; made small; and what it compares."""

from __future__ import annotations

import pytest

from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.study.check import load_study
from cleancli.study.model import Study

TEXT = """
study rags {
  about    = "rags"
  scene    = two_groups, scattered_40
  strategy = plan_2, reactive
  runs     = 4
  seed     = 7
  max_actions = 20
  rag      { width = 12 cm }
  part narrow { rag { width = 8 cm, 100 mm } }
  part held   { rag { grasp = folded }  strategy = plan_2 }
  quick { scene = two_groups  runs = 2  rag { width = 5 cm } }
  compare rivals {
    claim   = 2
    measure = moving
    expect  = equal
    margin  = 0.1
    scene   = scattered_40
    rag     { width = 8 cm }
    first   { strategy = plan_2  part = narrow }
    second  { strategy = reactive }
  }
}
"""


def load(text: str) -> Study:
    return load_study(Source("s.nid", text))


def test_a_part_says_what_all_parts_share_otherwise() -> None:
    narrow, held = load(TEXT).parts
    assert narrow.name == "narrow"
    assert narrow.axes == {
        "scene": ("two_groups", "scattered_40"),
        "strategy": ("plan-2", "reactive"),
        "rag.width": (0.08, 0.1),
    }
    assert held.axes["strategy"] == ("plan-2",)
    assert (held.axes["rag.width"], held.axes["rag.grasp"]) == ((0.12,), ("folded",))


def test_what_is_said_once_has_its_usual_value_where_it_is_not() -> None:
    study = load(TEXT)
    assert (study.runs, study.seed, study.episodes, study.about) == (4, 7, 1, "rags")
    assert (study.limits.max_actions, study.limits.max_seconds) == (20, 1800)
    assert study.measure == "seconds"


def test_a_quick_study_is_on_the_stand_in_and_as_small_as_it_says() -> None:
    quick = load(TEXT).quick
    assert quick is not None
    assert (quick.runs, quick.episodes) == (2, 1)
    for part in quick.parts:
        assert part.axes["simulator"] == ("stand-in",)
        assert part.axes["scene"] == ("two_groups",)
        assert part.axes["rag.width"] == (0.05,)


def test_a_quick_study_has_one_run_of_one_episode_where_nothing_is_said() -> None:
    quick = load("study s { scene = two_groups runs = 9 episodes = 10 }").quick
    assert quick is not None
    assert (quick.runs, quick.episodes) == (1, 1)


def test_a_comparison_selects_rows() -> None:
    (rivals,) = load(TEXT).comparisons
    assert (rivals.name, rivals.claim, rivals.measure, rivals.expect) == ("rivals", 2, "moving", "equal")
    assert (rivals.margin, rivals.factor, rivals.limit) == (0.1, 1, None)
    assert rivals.where == {"scene": ("scattered_40",), "rag.width": (0.08,)}
    assert rivals.first == {"strategy": ("plan-2",), "part": ("narrow",)}
    assert rivals.second == {"strategy": ("reactive",)}


def test_units_do_not_matter_for_what_is_the_same_length() -> None:
    text = TEXT.replace("rag     { width = 8 cm }", "rag { width = 80 mm }")
    assert load(text) == load(TEXT)


def test_a_study_may_consist_of_others_alone() -> None:
    study = load("study s { studies = one, two }")
    assert (study.studies, study.parts) == (("one", "two"), ())
    both = load("study s { studies = one  scene = two_groups }")
    assert len(both.parts) == 1


def test_a_comparison_is_of_what_the_study_shows_unless_it_names_another_measure() -> None:
    text = TEXT.replace("seed     = 7", "seed     = 7\n  measure  = actions")
    inheriting = text.replace("    measure = moving\n", "")
    assert [load(each).comparisons[0].measure for each in (text, inheriting)] == ["moving", "actions"]
    small = load(inheriting).quick
    assert small is not None
    assert small.comparisons[0].measure == "actions"
    assert load(TEXT.replace("    measure = moving\n", "")).comparisons[0].measure == "seconds"


@pytest.mark.parametrize(
    ("old", "new", "code"),
    [
        ("strategy = plan_2, reactive", "strategy = plan_2+, reactive", "E104"),
        ("strategy = plan_2, reactive", "strategy = plan_2, reactiv", "E506"),
        ("part narrow { rag { width = 8 cm, 100 mm } }", "part narrow { rag { width = 8, 100 mm } }", "E503"),
    ],
)
def test_no_comparison_is_wrong_because_a_value_could_not_be_read(old: str, new: str, code: str) -> None:
    """docs/diagnostics.md, E521: no cell has it; which cells there are is not known here."""
    with pytest.raises(Refused) as refused:
        load(TEXT.replace(old, new, 1))
    assert [each.code for each in refused.value.diagnostics] == [code]
