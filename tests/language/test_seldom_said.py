"""Mistakes that are seldom made: each is one message, at its place (docs/diagnostics.md)."""

from __future__ import annotations

from pathlib import Path

import pytest

from cleancli.language.diagnostics.diagnostic import Diagnostic, Level, Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.load import checked_domain, load_problem, read_source

TEXT = """\
domain d {
  types { place; area - place; tool }
  predicates { dirt(?a - area) wet(?a - area) near(?a ?b - area) [symmetric] fits(?t - tool, ?a - area) }
  functions { load(?a - area): 0..3 }
  derived { dirty := count ?a - area: dirt(?a) linked(?a ?b - area) := closure near }
  parameters { spill = 0.25 }
  actions { wipe(?a - area) [duration = 2 s, cost = 1] join(?a ?b - area) }
  rule wiped: wipe(?a) { when dirt(?a) then 0.5 [prior 0.5, seen 1]: not dirt(?a) rest: nothing }
  rule joined: join(?a, ?b) { when near(?a, ?b), dirt(?a), ?a != ?b then 1: not dirt(?a) }
  reward { decrease(dirty) - cost }
}
"""


def said(text: str) -> tuple[Diagnostic, ...]:
    """The mistakes of a text, without its warnings."""
    found = checked_domain(Source("d.nid", text)).diagnostics
    return tuple(diagnostic for diagnostic in found if diagnostic.level is Level.ERROR)


def test_the_domain_that_is_changed_is_right() -> None:
    assert said(TEXT) == ()


@pytest.mark.parametrize(
    ("old", "new", "code", "words"),
    [
        ("[prior 0.5, seen 1]", "[prior 0.5, prior 0.4, seen 1]", "E311", "a second `prior`"),
        ("[prior 0.5, seen 1]", "[prior 0.5, seen 1, seen 2]", "E311", "a second `seen`"),
        ("[prior 0.5, seen 1]", "[seen 1000000000.5]", "E311", "`seen` counts at most 1000000000 times"),
        ("rest: nothing", "rest [prior 0.5]: nothing", "E311", "`rest` has no prior of its own"),
        ("[prior 0.5, seen 1]", "[fixed, fixed]", "E311", "a second `fixed`"),
        ("[symmetric]", "[symmetric = 3]", "E213", "`symmetric` takes no value"),
        ("[symmetric]", "[symmetric, symmetric]", "E213", "a second `symmetric`"),
        ("[symmetric]", "[symetric]", "E213", "symetric"),
        ("duration = 2 s", "duration = 2 s, duration = 3 s", "E213", "a second duration"),
        ("duration = 2 s", "duration = 0 s", "E213", "a duration must be above 0 s"),
        ("duration = 2 s", "durations = 2 s", "E213", "durations"),
        ("cost = 1", "cost = 1, cost = 1", "E213", "a second cost"),
        ("area - place", "area - plaice", "E201", "plaice"),
        ("closure near", "closure nearby", "E203", "nearby"),
        ("dirty := count", "near := count", "E202", "`near` is already a predicate or function"),
        ("- cost", "- 1/0 * cost", "E302", "division by zero"),
        ("- cost", "- duration", "E227", "the reward counts durations, and no duration is known of: join"),
        ("wipe(?a) {", "wipe(a) {", "E204", "`a` is not a variable"),
        ("join(?a, ?b) {", "join(?a, ?a) {", "E202", "the variable `?a` stands here twice"),
        ("join(?a, ?b) {", "join(?a) {", "E208", "join"),
        ("rule wiped: wipe(?a)", "rule wiped: swipe(?a)", "E206", "swipe"),
        ("0.5 [prior 0.5, seen 1]:", "spill [seen 1]:", "E311", "stand where it is declared"),
        ("spill = 0.25", "spill = 1/0", "E302", "division by zero"),
        ("load(?a - area): 0..3", "load(?a - area): 3..0", "E224", "a range rises"),
        ("load(?a - area): 0..3", "load(?a - area): 0..1001", "E224", "at most 1000 values"),
    ],
)
def test_a_mistake_is_named_at_its_line(old: str, new: str, code: str, words: str) -> None:
    assert TEXT.count(old) == 1
    found = said(TEXT.replace(old, new))
    assert [diagnostic.code for diagnostic in found][:1] == [code]
    assert words in found[0].message
    assert found[0].span is not None
    line = TEXT[: TEXT.index(old)].count("\n")
    assert TEXT.replace(old, new)[: found[0].span.start].count("\n") == line


def test_a_variable_without_its_question_mark_is_suggested() -> None:
    (found,) = said(TEXT.replace("when dirt(?a) then", "when dirt(a) then"))
    assert found.code == "E205"
    assert "did you mean the variable `?a`" in (found.help or "")


def problem(inside: str) -> list[str]:
    domain = checked_domain(Source("d.nid", TEXT)).get()
    try:
        load_problem(Source("p.nid", f"problem p {{ domain = d objects {{ a - area }} {inside} }}"), domain)
    except Refused as refused:
        return [diagnostic.code for diagnostic in refused.diagnostics]
    return []


@pytest.mark.parametrize(
    ("inside", "code"),
    [
        ("planner { name = 3 }", "E504"),
        ('planner { name = "prada+" }', ""),
        ("planner { samples = 1.5 }", "E504"),
        ("planner { sample = 10 }", "E502"),
        ("planner { seed = 1 seed = 2 }", "E216"),
        ("planner { samples = 0 }", "E505"),
    ],
)
def test_settings_of_the_planner(inside: str, code: str) -> None:
    assert problem(f"init {{ load(a) = 0 }} {inside}") == ([code] if code else [])


def test_a_folder_in_the_place_of_a_file_is_named_where_it_is_included(tmp_path: Path) -> None:
    (tmp_path / "base.nid").mkdir()
    top = tmp_path / "top.nid"
    top.write_text(TEXT.replace("domain d {", 'domain d { include "base.nid"'))
    found = [each for each in checked_domain(read_source(top)).diagnostics if each.level is Level.ERROR]
    assert [diagnostic.code for diagnostic in found] == ["E002"]
    assert "base.nid" in found[0].message
    assert found[0].span is not None
    assert found[0].span.path == str(top)


def test_two_included_files_may_not_both_say_what_there_is_one_of(tmp_path: Path) -> None:
    for name in ("one", "two"):
        (tmp_path / f"{name}.nid").write_text(f"domain {name} {{ default {{ 1: nothing }} }}")
    top = tmp_path / "top.nid"
    top.write_text(TEXT.replace("domain d {", 'domain d { include "one.nid" include "two.nid"'))
    found = [each for each in checked_domain(read_source(top)).diagnostics if each.level is Level.ERROR]
    assert [diagnostic.code for diagnostic in found] == ["E216"]
    assert found[0].span is not None
    assert found[0].span.path.endswith("two.nid")
