"""The canonical layout: tokens and comments stay, and what has it keeps it."""

from __future__ import annotations

import random
import re
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.load import load_domain, read_source
from cleancli.language.parsing.parse import parse
from cleancli.language.parsing.trivia import tokens_of
from cleancli.language.printing.formatter import layout
from cleancli.resources import shipped

HERE = Path(__file__).parent
SHIPPED = [*sorted(shipped("domains").glob("*.nid")), *sorted(shipped("problems").glob("*.nid"))]
TEXTS = [read_source(path).text for path in [*SHIPPED, HERE / "small.nid"]]

SHORT = "domain d { types { area } actions { wipe() } rule r: wipe() { then 1: nothing } reward { cost } }"


def _comments(text: str) -> list[str]:
    return [comment.rstrip() for comment in re.findall(r"#[^\r\n]*", text)]


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.stem)
def test_shipped_files_have_the_layout(path: Path) -> None:
    text = read_source(path).text
    assert layout(text) == text


def test_everything_that_can_be_out_of_order() -> None:
    source = (HERE / "layout" / "untidy.nid").read_text(encoding="utf-8")
    assert layout(source) == (HERE / "layout" / "tidy.nid").read_text(encoding="utf-8")
    load_domain(Source("untidy", source))


@settings(max_examples=60, deadline=None)
@given(st.sampled_from(TEXTS), st.integers(0, 2**32), st.sampled_from(["\n", "\r\n", "\r"]))
def test_any_spacing_comes_to_an_end(text: str, seed: int, line_end: str) -> None:
    """Tokens with other gaps: the same tree and comments, in one step."""
    generator = random.Random(seed)
    gaps = [" ", "  ", "\t", line_end, line_end * 3, f" # remark {line_end}", f"{line_end} # own{line_end}"]
    untidy = line_end + "".join(
        token.text + generator.choices(gaps, [90, 5, 5, 9, 2, 3, 3])[0] for token in tokens_of(text)
    )
    tidy = layout(untidy)
    assert parse(Source("", tidy)).root == parse(Source("", text)).root
    assert _comments(tidy) == _comments(untidy)
    assert layout(tidy) == tidy
    assert set(re.findall(r"\r\n|\n|\r", tidy)) == {line_end}
    assert not re.search(r"[ \t](\r|\n|$)", tidy)
    assert line_end * 3 not in tidy
    assert tidy.endswith("}" + line_end) or tidy.splitlines()[-1].lstrip(" }").startswith("#")


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("problem p{}", "problem p { }\n"),
        ("problem p {\n\n}", "problem p { }\n"),
        ("problem p { # why\n}", "problem p {  # why\n}\n"),
        ("\ufeffproblem p { domain=d }\r\n", "\ufeffproblem p {\r\n  domain = d\r\n}\r\n"),
        ("scene s { rag { width=12 cm } }", "scene s {\n  rag { width = 12 cm }\n}\n"),
        ("scene s {dirt{at=( - 2 cm , 1 cm)}}", "scene s {\n  dirt { at = (-2 cm, 1 cm) }\n}\n"),
        ("# a\n\n\n# b\nproblem p { }\n# c", "# a\n\n# b\nproblem p { }\n# c\n"),
        ("problem p { } # a\n # b\n\n", "problem p { }  # a\n# b\n"),
        ("problem p { horizon=\n#why\n3 }", "problem p {\n  horizon =\n      #why\n      3\n}\n"),
    ],
)
def test_small_cases(before: str, after: str) -> None:
    assert layout(before) == after
    assert layout(after) == after


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("2*decrease(n)-0.5*m", "2 * decrease(n) - 0.5 * m"),
        ("decrease(n) - m + 10*goal - cost", "decrease(n) - m + 10 * goal - cost"),
        ("-2*m\t+  decrease(n)", "-2 * m + decrease(n)"),
    ],
)
def test_the_terms_of_a_reward_stand_one_blank_from_their_signs(before: str, after: str) -> None:
    """As docs/language.md writes them."""
    assert layout(f"domain d {{ reward {{ {before} }} }}") == f"domain d {{\n  reward {{ {after} }}\n}}\n"


def test_marks_stand_in_a_column_where_marks_stand_within_them() -> None:
    tidy = (
        "domain d {\n  actions {\n"
        "    push(?a - area)    [duration = 5.8 s [prior 9 s, seen 12.5], cost = 2]\n"
        "    wipe(?a ?b - area) [duration = 1 min [fixed]]\n"
        "    look()             [duration = 3 s]\n  }\n}\n"
    )
    untidy = tidy.replace("  ", "").replace(", ", " ,").replace("[prior", "[  prior")
    assert layout(untidy) == tidy
    assert layout(tidy) == tidy


def test_a_reward_that_is_too_wide_has_a_term_to_a_line_with_its_sign() -> None:
    terms = [f"{n} * count_number_{n}_of_many" for n in range(1, 6)]
    tidy = layout(f"domain d {{ reward {{ -{' - '.join(terms)} }} }}")
    first, *others = tidy.splitlines()[2:7]
    assert first == f"    -{terms[0]}"
    assert others == [f"    - {term}" for term in terms[1:]]
    assert layout(tidy) == tidy


@pytest.mark.parametrize("text", [SHORT, TEXTS[-1]])
def test_rules_are_never_on_one_line(text: str) -> None:
    """docs/commands.md; whatever line it was all written on."""
    words = " ".join(re.sub(r"#[^\r\n]*", "", text).split())
    lines = layout(words).splitlines()
    begun = [line for line in lines if re.match(r"\s*(when|then|with)\b", line)]
    assert len(begun) == sum(token.type in {"WHEN", "THEN", "WITH"} for token in tokens_of(words))
    assert all(line.endswith("{") for line in lines if re.match(r"\s*rule\b", line))


def test_a_comment_that_goes_on_below_stays_in_its_column() -> None:
    text = "problem p {\n  horizon = 3  # first\n               # and second\n  # alone\n  discount = 1\n}\n"
    assert layout(text) == text.replace("horizon =", "horizon  =").replace("    #", "     #", 1)


def test_what_is_too_wide_is_broken_once() -> None:
    facts = " ".join(f"dirt(area_number_{n})" for n in range(8))
    tidy = layout(f"problem p {{ init {{ {facts} }} }}")
    assert tidy.splitlines()[2:10] == [f"    {fact}" for fact in facts.split()]
    assert layout(tidy) == tidy


def test_mistakes_are_refused() -> None:
    with pytest.raises(Refused) as refused:
        layout("problem p { horizon 3 }", "p.nid")
    assert refused.value.diagnostics[0].code == "E104"
    assert refused.value.sources[0].path == "p.nid"
