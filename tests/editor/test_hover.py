"""What is shown over a name."""

from __future__ import annotations

import pytest

from cleancli.editor.hover import hover
from support.editor_texts import DOMAIN, OPEN, at, marked


def shown(name: str, mark: str) -> str:
    asked, offset = at(name, mark)
    found = hover(asked, offset, OPEN)
    assert found is not None
    assert found.span.start <= offset <= found.span.end
    return found.text


@pytest.mark.parametrize(
    ("name", "mark", "expected"),
    [
        ("tables.nid", "when |dirt(?x)", ["predicate dirt(?a - area)", "a dirty area 🧽 on the surface"]),
        ("two.nid", "|near(a1", ["predicate near(?a ?b - area) [symmetric]", "two areas\nside by side"]),
        ("tables.nid", "(|?x)", ["variable ?x - area"]),
        ("tables.nid", "not dirt(|?m)", ["variable ?m - area"]),
        ("tables.nid", "join(?a, |?b)", ["variable ?b - area"]),
        ("tables.nid", ": |push(?x)", ["action push(?a - area) [duration = 9 s]"]),
        ("tables.nid", "?x) = |small", ["value small of size(?a - area): small < medium < big"]),
        ("tables.nid", "bin - |container", ["type container - place"]),
        ("two.nid", "a1, |bin", ["object bin - container"]),
        ("two.nid", "near(|a1", ["object a1 - area"]),
        ("two.nid", "+ |dirty_areas", ["derived dirty_areas := count ?a - area: dirt(?a)"]),
        ("two.nid", "= |tables", ["domain tables", "Tables and what lies on them."]),
        ("little.nid", "|width", ["**width**: the rag's width"]),
    ],
)
def test_declarations(name: str, mark: str, expected: list[str]) -> None:
    text = shown(name, mark)
    for words in expected:
        assert words in text


@pytest.mark.parametrize(
    "paid", ["reward += |weight(?x)", "reward -= 2 + 0.5 * |weight(?x)", "cost += |weight(bin)"]
)
def test_what_an_outcome_pays_by_is_declared_somewhere(paid: str) -> None:
    asked, offset, library = marked("tables.nid", DOMAIN.replace("size(?x) := medium", paid))
    found = hover(asked, offset, library)
    assert found is not None
    assert "function weight(?a - area): small < large" in found.text


def test_a_rule_sums_its_outcomes_and_counts_its_groundings() -> None:
    text = shown("tables.nid", "rule |push_small")
    assert "rule push_small: push(?x)" in text
    assert "the easy one" in text
    assert "3 outcomes: 0.75 change, 0.25 noise" in text
    assert "`two.nid`: 2 groundings" in text
    # Both areas must differ and the first be light, which never changes: that leaves one of four tuples.
    assert shown("tables.nid", "rule |join_two").endswith("`two.nid`: 1 grounding")


def test_a_probability_tells_what_was_learned() -> None:
    text = shown("tables.nid", "|0.65 [prior")
    assert text == "now `0.65`; before anything was learned `0.6`; seen 14 times"


@pytest.mark.parametrize(
    ("said", "told"), [("1", "seen 1 time"), ("12.40", "seen 12.4 times"), ("0.5", "seen 0.5 times")]
)
def test_a_count_may_be_a_fraction_and_that_of_the_rest_is_told_too(said: str, told: str) -> None:
    asked, offset, library = marked("tables.nid", DOMAIN.replace("rest:", f"|rest [seen {said}]:"))
    found = hover(asked, offset, library)
    assert found is not None
    assert found.text == f"now `rest`; {told}"


def test_a_duration_tells_what_was_learned() -> None:
    text = DOMAIN.replace("[duration = 9 s]", "[cost = 2, duration = |5.8 s [prior 9 s, seen 12.5]]")
    asked, offset, library = marked("tables.nid", text)
    found = hover(asked, offset, library)
    assert found is not None
    assert found.text == "now `duration = 5.8 s`; before anything was learned `9 s`; seen 12.5 times"


@pytest.mark.parametrize(
    ("mark", "expected"),
    [
        ("|estimator = m", "`decreasing_m`, `m`, `fitted_m`, `likelihood`"),
        ("|m = 10", "how many examples the prior weighs as much as"),
        ("|match = shared", "`shared`, `strict`"),
    ],
)
def test_the_settings_of_what_was_learned_are_explained(mark: str, expected: str) -> None:
    block = "learned { estimator = m  m = 10  match = shared }".replace(mark.replace("|", ""), mark)
    asked, offset, library = marked("tables.nid", f"{DOMAIN.rstrip()[:-1]}  {block}\n}}\n")
    found = hover(asked, offset, library)
    assert found is not None
    assert found.text.startswith(f"**{mark[1:].split()[0]}**: ")
    assert expected in found.text


def test_there_is_nothing_to_say_about_blanks_and_unlearned_numbers() -> None:
    asked, offset = at("tables.nid", "|0.9: not")
    assert hover(asked, offset, OPEN) is None
    asked, offset, library = marked("tables.nid", DOMAIN + "\n\n|\n")
    assert hover(asked, offset, library) is None


def test_a_rule_of_a_domain_with_mistakes_still_shows_its_head() -> None:
    asked, offset, library = marked(
        "tables.nid", DOMAIN.replace("0.9:", "0.8:").replace("push_", "push|_", 1)
    )
    found = hover(asked, offset, library)
    assert found is not None
    assert "rule push_small: push(?x)" in found.text
    assert "outcomes" not in found.text
