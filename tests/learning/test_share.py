"""Fixed outcomes and shared parameters: who keeps what, and that a rule still sums to 1."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from cleancli.api.lessons import learn as learned_from
from cleancli.compiler.fluents import values_of
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.text_edit import apply_edits
from cleancli.language.load import checked_domain, load_domain, read_source
from cleancli.language.model import Fact, Object, Outcome, OutcomeKind, State
from cleancli.learning.edits import edits
from cleancli.learning.experience import Transition, encode
from cleancli.learning.learn import learn
from cleancli.learning.share import exactly, shared_out

TEXT = """\
domain mop {
  types      { area }
  predicates { dirt(?a - area)  wet(?a - area) }
  functions  { load(?a - area): 0..3 }
  derived    { left := count ?a - area: dirt(?a) }
  parameters { spill = 0.2 }
  actions    { wipe(?a - area) rinse(?a - area) drop(?a - area) }
  rule wipe_it: wipe(?a) {
    when dirt(?a)
    then 0.5: not dirt(?a)
         spill: wet(?a)
         rest: noise
  }
  rule rinse_it: rinse(?a) {
    when dirt(?a)
    then spill: wet(?a)
         0.8: not dirt(?a)
  }
  rule drop_it: drop(?a) {
    when dirt(?a)
    then 1/3 [fixed]: noise
         1/3: load(?a) += 2
         1/3: nothing
  }
  reward { decrease(left) }
}
"""
ROOM = (Object("a", "area"),)


def _state(*true: str, load: int = 0) -> State:
    return frozenset({Fact("load", ("a",), load), *(Fact(name, ("a",)) for name in true)})


def _transition(action: str, after: State, before: State | None = None) -> Transition:
    return Transition(action, ("a",), ROOM, values_of(before or _state("dirt")), values_of(after))


def test_a_parameter_pools_the_examples_of_its_rules() -> None:
    domain = load_domain(Source("mop.nid", TEXT))
    wet, gone = _state("dirt", "wet"), _state()
    experience = [_transition("wipe", wet), _transition("rinse", wet), _transition("rinse", gone)]
    wipe, rinse = learn(domain, experience).rules
    # Eq. 5 with 2 of 3: m / sqrt(3) = 5.7735.
    spill = (2 + 5.7735 * 0.2) / (3 + 5.7735)
    assert float(wipe.probabilities[1]) == pytest.approx(spill, abs=1e-4)
    assert wipe.probabilities[1] == rinse.probabilities[0]
    assert rinse.probabilities[1] == 1 - rinse.probabilities[0]
    assert sum(wipe.probabilities) == 1
    text = apply_edits(TEXT, edits(domain, [Source("mop.nid", TEXT)], (wipe, rinse)))
    assert "spill = 0.3596 [prior 0.2, seen 2]" in text
    assert "0.6404 [prior 0.8, seen 1]: not dirt(?a)" in text
    again = load_domain(Source("mop.nid", text))
    assert apply_edits(text, edits(again, [Source("mop.nid", text)], learn(again, experience).rules)) == text


def test_a_rule_without_examples_makes_room_for_its_parameter() -> None:
    domain = load_domain(Source("mop.nid", TEXT))
    learned = learn(domain, [_transition("wipe", _state("dirt", "wet"))]).rules
    text = apply_edits(TEXT, edits(domain, [Source("mop.nid", TEXT)], learned))
    rinse = load_domain(Source("mop.nid", text)).rules[1]
    assert rinse.outcomes[0].probability > Fraction(1, 5)
    assert sum(o.probability for o in rinse.outcomes) == 1


def test_what_is_fixed_stays_and_a_shift_is_explained() -> None:
    domain = load_domain(Source("mop.nid", TEXT))
    saturated = _transition("drop", _state("dirt", load=3), _state("dirt", load=2))
    (learned,) = learn(domain, [saturated] * 5).rules
    assert tuple(map(float, learned.seen)) == (0, 5, 0)
    assert learned.probabilities[0] == Fraction(1, 3)
    assert learned.probabilities[1] > Fraction(1, 2)
    assert sum(learned.probabilities) == 1
    text = apply_edits(TEXT, edits(domain, [Source("mop.nid", TEXT)], (learned,)))
    assert "1/3 [fixed]: noise" in text
    assert load_domain(Source("mop.nid", text)).rules[2].outcomes[1].seen == 5


def test_each_number_goes_to_the_file_that_holds_it(tmp_path: Path) -> None:
    base, top = tmp_path / "base.nid", tmp_path / "top.nid"
    base.write_text("domain base { parameters { spill = 0.2 } }")
    top.write_text(
        TEXT.replace("domain mop {", 'domain mop { include "base.nid"').replace(
            "  parameters { spill = 0.2 }\n", ""
        )
    )
    checked = checked_domain(read_source(top))
    domain = checked.get()
    found = edits(domain, checked.sources, learn(domain, [_transition("wipe", _state("dirt", "wet"))]).rules)
    in_base = [edit for edit in found if edit.span.path == str(base)]
    assert "[prior 0.2, seen 1]" in apply_edits(base.read_text(), in_base)
    assert {edit.span.path for edit in found} == {str(base), str(top)}


def shared_exactly(
    outcomes: Sequence[Outcome], estimates: Sequence[float], shared: Mapping[str, Fraction]
) -> tuple[Fraction, ...]:
    """What outcomes get, as the text says it."""
    found = shared_out(outcomes, estimates, {name: float(value) for name, value in shared.items()})
    return exactly(outcomes, found, shared)


@given(
    st.lists(st.tuples(st.sampled_from(["free", "fixed", "shared"]), st.integers(0, 30)), min_size=1),
    st.booleans(),
    st.integers(1, 30),
)
def test_a_rule_always_sums_to_one(parts: list[tuple[str, int]], has_rest: bool, last: int) -> None:
    total = sum(weight for _, weight in parts) + last
    outcomes = [
        Outcome(
            Fraction(weight, total),
            OutcomeKind.NOTHING,
            fixed=kind == "fixed",
            parameter=f"p{number}" if kind == "shared" else None,
        )
        for number, (kind, weight) in enumerate(parts)
    ]
    outcomes.append(Outcome(Fraction(last, total), OutcomeKind.NOISE, is_rest=has_rest))
    shared = {o.parameter: o.probability for o in outcomes if o.parameter is not None}
    estimates = [1 / len(outcomes)] * len(outcomes)
    result = shared_exactly(outcomes, estimates, shared)
    assert sum(result) == 1
    assert all(0 <= p <= 1 for p in result)
    assert all(p == o.probability for p, o in zip(result, outcomes, strict=True) if o.fixed)


def test_what_is_added_to_a_shared_parameter_counts_for_all_its_rules_together(tmp_path: Path) -> None:
    """In two steps it comes to what it does at once: what rules share does not count for each of them."""
    wet, gone = _state("dirt", "wet"), _state()
    first = (
        [_transition("wipe", wet)] * 6 + [_transition("wipe", gone)] * 6 + [_transition("rinse", gone)] * 12
    )
    second = [_transition("rinse", wet)] * 2 + [_transition("wipe", gone)] * 4
    files = [tmp_path / name for name in ("a.jsonl", "b.jsonl")]
    for path, experience in zip(files, (first, second), strict=True):
        path.write_text("".join(encode(each, {}) + "\n" for each in experience), encoding="utf-8")
    steps, once = tmp_path / "steps.nid", tmp_path / "once.nid"
    for path in (steps, once):
        path.write_text(TEXT, encoding="utf-8")
    learned_from(steps, files[0], write=True)
    learned_from(steps, files[1], add=True, write=True)
    learned_from(once, *files, write=True)
    found, expected = (load_domain(read_source(path)) for path in (steps, once))
    assert found.parameters[0].seen == expected.parameters[0].seen == 8
    spill, at_once = (float(domain.parameters[0].probability) for domain in (found, expected))
    assert spill == pytest.approx(at_once, abs=2e-4)
    assert sum(o.seen or 0 for o in found.rules[1].outcomes[1:]) == 12
