"""What a transition counts as, and what learning writes into the text."""

from __future__ import annotations

import io
from fractions import Fraction

import pytest

from cleancli.compiler.fluents import values_of
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.diagnostics.text_edit import apply_edits
from cleancli.language.load import load_domain
from cleancli.language.model import Domain, Fact, Object, State
from cleancli.learning.edits import edits
from cleancli.learning.expectation import likeliest_outcome, prior_beliefs
from cleancli.learning.experience import Transition, decode, encode
from cleancli.learning.learn import learn
from cleancli.learning.match import Matcher
from cleancli.learning.method import Method

TEXT = """\
domain tidy {
  types      { box }
  predicates { dirty(?b - box)  wet(?b - box)  beside(?a ?b - box) [symmetric] }
  functions  { size(?b - box): small < large }
  derived    { left := count ?b - box: dirty(?b) }
  actions    { wipe(?b - box) }
  rule wipe_large: wipe(?b) {              # the comment stays
    when dirty(?b), size(?b) = large
    then 0.5:   not dirty(?b), forall ?o - box: beside(?b, ?o) => not dirty(?o)
         0.25:  size(?b) := small
         0.125 :wet(?b)
         rest: noise
  }
  rule wipe_small: wipe(?b) {
    when dirty(?b), size(?b) = small
    then 0.6 [prior 0.7,  seen  3]: not dirty(?b)
         0.3 [prior 0.2, seen 1]: nothing
         0.1 [prior 0.1, seen 0]: noise
  }
  default { 0.9: nothing  0.1: noise }
  reward  { decrease(left) }
}
"""
BOXES = (Object("b1", "box"), Object("b2", "box"), Object("b3", "box"))


@pytest.fixture(scope="module")
def domain() -> Domain:
    return load_domain(Source("tidy.nid", TEXT))


def state(*dirty: str, wet: tuple[str, ...] = (), small: tuple[str, ...] = ()) -> State:
    """The boxes b1 to b3; b1 stands beside b2."""
    facts = {Fact("dirty", (name,)) for name in dirty} | {Fact("wet", (name,)) for name in wet}
    facts |= {Fact("size", (box.name,), "small" if box.name in small else "large") for box in BOXES}
    return frozenset(facts | {Fact("beside", ("b1", "b2"))})


def wiped(after: State, before: State | None = None, box: str = "b1") -> Transition:
    return Transition("wipe", (box,), BOXES, values_of(before or state("b1", "b2", "b3")), values_of(after))


def strictly(domain: Domain, transition: Transition) -> tuple[int | None, int | None]:
    """The covering rule, and the outcome that a transition counts for by the paper's reading (§5)."""
    match = Matcher(domain, strict=True).match(transition)
    return match.rule, likeliest_outcome(match, prior_beliefs(domain))


@pytest.mark.parametrize(
    ("after", "outcome"),
    [
        (state("b3"), 0),
        (state("b1", "b2", "b3", small=("b1",)), 1),
        (state("b1", "b2", "b3", wet=("b1",)), 2),
        (state("b2", "b3"), 3),
        (state("b1", "b2", "b3"), 3),
        (state("b3", wet=("b1",)), 3),
    ],
    ids=["gone with its neighbour", "shrunk", "wet", "neighbour stays", "no change", "gone but wet"],
)
def test_outcome_that_explains(domain: Domain, after: State, outcome: int) -> None:
    assert strictly(domain, wiped(after)) == (0, outcome)


def test_what_changes_elsewhere_does_not_count(domain: Domain) -> None:
    assert strictly(domain, wiped(state(small=("b3",)))) == (0, 0)


def test_no_covering_rule_is_the_default_rule(domain: Domain) -> None:
    before = state("b2")
    assert strictly(domain, wiped(before, before)) == (None, 0)
    assert strictly(domain, wiped(state("b1", "b2"), before)) == (None, 1)


def test_noise_takes_what_no_outcome_explains(domain: Domain) -> None:
    (learned,) = learn(domain, [wiped(state("b2", "b3", wet=("b1",)))] * 4).rules
    assert tuple(map(float, learned.seen)) == (0, 0, 0, 4)
    # Eq. 5 with m / sqrt(4) = 5: the prior keeps 5 / 9 of its weight.
    assert [float(p) for p in learned.probabilities] == pytest.approx(
        [0.5 * 5 / 9, 0.25 * 5 / 9, 0.125 * 5 / 9, (4 + 0.125 * 5) / 9], abs=1e-4
    )
    assert sum(learned.probabilities) == 1


def test_only_the_learned_rule_changes_and_only_its_numbers(domain: Domain) -> None:
    text = apply_edits(
        TEXT, edits(domain, [Source("tidy.nid", TEXT)], learn(domain, [wiped(state("b3"))]).rules)
    )
    assert text == (
        TEXT.replace("0.5: ", "0.5455 [prior 0.5, seen 1]: ")
        .replace("0.25: ", "0.2273 [prior 0.25, seen 0]: ")
        .replace("0.125 :", "0.1136 [prior 0.125, seen 0] :")
        .replace("rest: noise", "rest [seen 0]: noise")
    )
    assert (
        sum(outcome.probability for outcome in load_domain(Source("tidy.nid", text)).rules[0].outcomes) == 1
    )


def test_a_count_with_a_point_is_replaced_whole(domain: Domain) -> None:
    before = TEXT.replace("seen  3", "seen  12.4375").replace("rest: noise", "rest [seen 3.5]: noise")
    counted = load_domain(Source("tidy.nid", before))
    assert [outcome.seen for outcome in counted.rules[1].outcomes] == [Fraction(199, 16), 1, 0]
    assert counted.rules[0].outcomes[3].seen == Fraction(7, 2)
    small = state("b1", small=("b1",))
    learned = learn(counted, [wiped(state(small=("b1",)), small)]).rules
    after = apply_edits(before, edits(counted, [Source("tidy.nid", before)], learned))
    assert "[prior 0.7,  seen  1]: not dirty(?b)" in after
    assert "rest [seen 3.5]: noise" in after


def test_learning_again_from_the_same_experience_changes_nothing(domain: Domain) -> None:
    experience = [wiped(state("b3"))] * 3 + [wiped(state("b1", "b2", "b3", wet=("b1",)))] * 2
    once = apply_edits(TEXT, edits(domain, [Source("tidy.nid", TEXT)], learn(domain, experience).rules))
    again = load_domain(Source("tidy.nid", once))
    assert apply_edits(once, edits(again, [Source("tidy.nid", once)], learn(again, experience).rules)) == once


def test_the_prior_in_the_file_counts_not_the_last_estimate(domain: Domain) -> None:
    before = state("b1", small=("b1",))
    (learned,) = learn(domain, [wiped(state(small=("b1",)), before)]).rules
    assert learned.priors == (Fraction(7, 10), Fraction(2, 10), Fraction(1, 10))
    text = apply_edits(TEXT, edits(domain, [Source("tidy.nid", TEXT)], (learned,)))
    assert "0.7273 [prior 0.7,  seen  1]: not dirty(?b)" in text
    assert "[prior 0.2, seen 0]: nothing" in text


def test_experience_survives_its_file(domain: Domain) -> None:
    transitions = (wiped(state("b3")), wiped(state("b1", small=("b1",)), box="b3"))
    text = "".join(encode(t, {"number": 1}) + "\n" for t in transitions)
    assert tuple(decode(io.BytesIO(text.encode()), "x", domain)) == transitions
    torn = text + encode(transitions[0], {})[:70]
    assert tuple(decode(io.BytesIO(torn.encode()), "x", domain)) == transitions


def test_every_bad_line_is_reported(domain: Domain) -> None:
    good = encode(wiped(state("b3")), {})
    lines = [
        "not json",
        good,
        "[1]",
        good.replace('"wipe"', '"wash"'),
        good.replace('["b1"], "objects"', '["b1", "b2"], "objects"'),
        good.replace('["dirty", ["b3"], true]', '["dirty", ["b9"], true]'),
        good.replace('["b1"], "large"', '["b1"], "huge"', 1),
        '{"action": "wipe", "arguments": ["b1"], "objects": {"b1": "box"}, "before": []}',
    ]
    with pytest.raises(Refused) as refused:
        tuple(decode(io.BytesIO(("\n".join(lines) + "\n").encode()), "x", domain))
    assert [d.code for d in refused.value.diagnostics] == ["E701"] * 7


# ---- actions that no rule covers

COINS = """\
domain coins {
  types      { coin }
  predicates { heads(?c - coin) }
  derived    { up := count ?c - coin: heads(?c) }
  actions    { flip(?c - coin)  couple(?a ?b - coin)  wait() }
  rule flip_it: flip(?c) {
    then 0.5: heads(?c)
         0.5: not heads(?c)
  }
  rule couple_them: couple(?a, ?b) {
    when ?a != ?b
    then 0.9: heads(?a), heads(?b)
         0.1: nothing
  }
%s  reward { decrease(up) }
}
"""


@pytest.mark.parametrize(
    "default", ["", "  default { 1: nothing }\n", "  default { 0.5: nothing 0.5: noise }\n"]
)
def test_what_no_rule_covers_is_the_default_rules_written_or_not(default: str) -> None:
    """Without a `default`, nothing is what is expected, and no number stands anywhere to be changed."""
    text = COINS % default
    source = Source("coins.nid", text)
    domain = load_domain(source)
    coins = (Object("c1", "coin"), Object("c2", "coin"))
    up = frozenset({Fact("heads", ("c1",))})
    moves = [
        Transition("flip", ("c1",), coins, values_of(up), values_of(frozenset())),
        Transition("couple", ("c1", "c1"), coins, values_of(frozenset()), values_of(frozenset())),
        Transition("couple", ("c1", "c1"), coins, values_of(frozenset()), values_of(up)),
        Transition("wait", (), coins, values_of(up), values_of(up)),
    ]
    strict = Method(match="strict")
    learned = {entry.rule: entry for entry in learn(domain, moves, strict).rules}
    assert learned.keys() == {0, None}
    assert tuple(map(float, learned[0].seen)) == (0, 1)
    # Eq. 5 with m / sqrt(1) = 10.
    assert [float(p) for p in learned[0].probabilities] == pytest.approx([5 / 11, 6 / 11], abs=1e-4)
    assert tuple(map(float, learned[None].seen)) == ((2, 1) if "noise" in default else (2,))
    assert learned[None].unexplained == (0 if "noise" in default else 1)
    after = apply_edits(text, edits(domain, [source], tuple(learned.values())))
    assert "0.5455 [prior 0.5, seen 1]: not heads(?c)" in after
    if not default:
        assert "default" not in after
        assert (
            after.replace("0.4545 [prior 0.5, seen 0]", "0.5").replace("0.5455 [prior 0.5, seen 1]", "0.5")
            == text
        )
    again = load_domain(Source("coins.nid", after))
    assert (
        apply_edits(after, edits(again, [Source("coins.nid", after)], learn(again, moves, strict).rules))
        == after
    )
