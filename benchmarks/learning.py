"""How well probabilities are learned: python benchmarks/learning.py [--part PART ...] [--keep FILE] ...

Transitions are drawn from rules whose probabilities are hidden: those of `cleaning` and of
benchmarks/domains/coins.nid with probabilities drawn at random. Learned are the shipped numbers. What is
learned is compared with the hidden rules by the total variation of next states: half of what the two
distributions over the states after an action differ by, in the mean over actions and states that are drawn
anew.

`recovery`: after 5,000 transitions, beside a learner that is told which outcome each transition was, and
beside the least that any learner without a prior can expect (the bound of Cramér and Rao), told and not; and
starting from the hidden probabilities themselves, which more transitions should not spoil.
`curves`: the estimators after 3 to 300 examples of each rule, from a wrong prior and from the right
one.
`changes`: where the hidden probabilities become others midway, in how many rules that is found, and how far
off its place; in how many it is found where nothing changed; and what is learned of the later ones with
forgetting and without.

About five minutes of CPU for five seeds. With --keep each seed is a line of FILE, and not drawn again.
`--quick` draws 300 transitions of one seed, in about ten seconds.
"""

from __future__ import annotations

import argparse
import functools
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import islice
from pathlib import Path
from statistics import mean, median, stdev

import numpy as np
from instances import Rng, shipped
from kept import Kept, Row

from cleancli.array_types import Floats
from cleancli.compiler.conflict import results
from cleancli.compiler.fluents import Fluent, Values, values_of
from cleancli.compiler.ground import ground
from cleancli.compiler.lifted_state import LiftedRules
from cleancli.language.load import load_domain, read_source
from cleancli.language.model import Domain, Fact, Object, Outcome, Problem, Rule, Value
from cleancli.learning.changes import FEWEST, RuleChange, changes
from cleancli.learning.estimate import ESTIMATORS, FITTED
from cleancli.learning.evidence import collected
from cleancli.learning.expectation import Beliefs, SlipRates, maximised, prior_beliefs, shares
from cleancli.learning.experience import Transition
from cleancli.learning.learn import learn, learned_from
from cleancli.learning.match import Match, Matcher
from cleancli.learning.method import DEFAULT, Method

FOLDER = Path(__file__).parent / "domains"
STEPS = 12
"""Actions of a walk, after which another problem is drawn."""
TESTED = 300
"""Actions and states on which rules are compared."""
LITTLE = 0.2
"""Total variation of a rule's outcomes up to which a change is little."""
FORGETTING = 0.01
CURVE = (3, 6, 12, 25, 50, 100, 300)
"""Examples of a rule."""


@dataclass(frozen=True, slots=True)
class Drawn:
    """A transition, and which outcome of which rule it was."""

    transition: Transition
    rule: int
    outcome: int


# ---- hidden rules, and what they do


@functools.cache
def _coins() -> Domain:
    return load_domain(read_source(FOLDER / "coins.nid"))


def coins(rng: Rng) -> tuple[Domain, Problem]:
    """Two to five coins, each as likely heads as not."""
    domain = _coins()
    names = [f"c{number}" for number in range(1, int(rng.integers(3, 7)))]
    facts = frozenset(Fact("heads", (name,)) for name in names if rng.random() < 0.5)
    return domain, Problem("coins", domain.name, tuple(Object(name, "coin") for name in names), facts)


DRAW: Mapping[str, Callable[[Rng], tuple[Domain, Problem]]] = {"cleaning": shipped, "coins": coins}


def hidden(domain: Domain, rng: Rng) -> Domain:
    """The domain with probabilities drawn uniformly from all that there are."""
    return replace(domain, rules=tuple(_hidden(rule, rng) for rule in domain.rules))


def _hidden(rule: Rule, rng: Rng) -> Rule:
    chances = rng.dirichlet([1.0] * len(rule.outcomes))
    return replace(rule, outcomes=_with(rule.outcomes, [Fraction(float(chance)) for chance in chances]))


def _with(outcomes: Sequence[Outcome], chances: Sequence[Fraction]) -> tuple[Outcome, ...]:
    return tuple(
        replace(outcome, probability=chance / sum(chances), prior=None, is_rest=False)
        for outcome, chance in zip(outcomes, chances, strict=True)
    )


def taught(domain: Domain, beliefs: Beliefs) -> Domain:
    """The domain with the probabilities that are believed."""
    rules = []
    for number, rule in enumerate(domain.rules):
        chances = [Fraction(chance) for chance in beliefs.probabilities[number]]
        rules.append(replace(rule, outcomes=_with(rule.outcomes, chances)))
    return replace(domain, rules=tuple(rules))


def draw(name: str, truth: Domain, rng: Rng) -> Iterator[Drawn]:
    """Transitions without end, of actions that a rule covers, on walks from random states."""
    rules = LiftedRules(truth)
    while True:
        _, problem = DRAW[name](rng)
        task = ground(truth, problem)
        values: Values = values_of(problem.state)
        asked = [(action.name, action.objects) for action in task.actions]
        for _ in range(STEPS):
            state = rules.state(problem.objects, values)
            # The first that is covered, in random order, is any of them alike.
            order = (asked[index] for index in rng.permutation(len(asked)).tolist())
            covered = next(((each, found) for each in order if (found := rules.covering(state, *each))), None)
            if covered is None:
                break
            (action, arguments), (rule, names) = covered
            outcomes = truth.rules[rule].outcomes
            outcome = int(rng.choice(len(outcomes), p=[float(o.probability) for o in outcomes]))
            after = changed(values, results(rules, state, rule, names)[outcome])
            yield Drawn(Transition(action, arguments, problem.objects, values, after), rule, outcome)
            values = after


def changed(values: Values, sets: Mapping[Fluent, Value]) -> Values:
    """The values after an outcome set some."""
    return {key: value for key, value in {**values, **sets}.items() if value is not False}


def difference(one: Domain, other: Domain, asked: Sequence[Drawn]) -> float:
    """The total variation of next states, in the mean."""
    rules = LiftedRules(one)
    return mean(_difference(rules, one, other, each) for each in asked)


def _difference(rules: LiftedRules, one: Domain, other: Domain, asked: Drawn) -> float:
    outcomes = zip(one.rules[asked.rule].outcomes, other.rules[asked.rule].outcomes, strict=True)
    more = np.array([float(p.probability - q.probability) for p, q in outcomes])
    return float(np.abs(np.array(_led_to(rules, asked)) @ more).sum()) / 2


# ---- the parts


def recovery(name: str, seed: int, transitions: int) -> Row:
    """Differences from the hidden rules: of what is learned, of what is learned when told the outcomes, of
    what is learned from the right rules, before learning, and by the strict reading; and with the estimator
    `fitted-m`."""
    rng = np.random.default_rng([seed, 1])
    given = DRAW[name](rng)[0]
    truth = hidden(given, rng)
    source = draw(name, truth, rng)
    seen, asked = ([next(source) for _ in range(number)] for number in (transitions, TESTED))
    experience = [each.transition for each in seen]
    found = {
        "before": given,
        "told": taught(given, _told(given, seen)),
        "strict": taught(given, learn(given, experience, Method(match="strict")).beliefs),
        "right and told": taught(truth, _told(truth, seen)),
    }
    for start, learned, fitted in ((given, "learned", "fitted"), (truth, "from right", "fitted from right")):
        evidence = collected(Matcher(start), experience)
        for key, method in ((learned, DEFAULT), (fitted, Method(FITTED))):
            found[key] = taught(start, learned_from(start, evidence, method).beliefs)
    row = {key: difference(truth, domain, asked) for key, domain in found.items()}
    matches = map(Matcher(truth).match, experience)
    row["bound"] = expected_difference(truth, _least_errors(truth, matches), asked)
    row["bound when told"] = expected_difference(truth, _errors_when_told(truth, seen), asked)
    return row


Errors = Mapping[int, Floats]
"""By the rule, the covariance of the errors of its probabilities (outcomes, outcomes)."""


def _errors_when_told(truth: Domain, seen: Sequence[Drawn]) -> Errors:
    """Of the shares of outcomes that are known: those of multinomial counts."""
    numbers = Counter(each.rule for each in seen)
    return {rule: _spread_of(truth, rule) / number for rule, number in numbers.items()}


def _least_errors(truth: Domain, matches: Iterable[Match]) -> Errors:
    """Of any unbiased estimate from what is seen, at least (Cramér and Rao). The score of an outcome's logit
    is its share less its probability."""
    priors = {rule: _chances(truth, rule) for rule in range(len(truth.rules))}
    beliefs = Beliefs({rule: tuple(p) for rule, p in priors.items()}, {}, SlipRates(1e-9, 1e-9))
    scores: dict[int, list[Floats]] = {}
    for match in matches:
        if match.rule is not None:
            score = np.array(shares(match, beliefs)) - priors[match.rule]
            scores.setdefault(match.rule, []).append(score)
    found = {}
    for rule, each in scores.items():
        slope = _spread_of(truth, rule)  # of probabilities by their logits
        information = np.array(each).T @ np.array(each)
        found[rule] = slope @ np.linalg.pinv(information, rcond=1e-9, hermitian=True) @ slope
    return found


def _spread_of(truth: Domain, rule: int) -> Floats:
    """The covariance of one draw of an outcome."""
    chances = _chances(truth, rule)
    return np.diag(chances) - np.outer(chances, chances)


def _chances(truth: Domain, rule: int) -> Floats:
    return np.array([float(outcome.probability) for outcome in truth.rules[rule].outcomes])


def expected_difference(truth: Domain, errors: Errors, asked: Sequence[Drawn]) -> float:
    """The total variation of next states that errors come to if they follow the normal distribution, whose
    mean distance from 0 is the standard deviation times the root of 2 / π; of rules that there were examples
    of."""
    rules = LiftedRules(truth)
    found = []
    for each in (each for each in asked if each.rule in errors):
        alike = np.array(_led_to(rules, each))
        variances = np.einsum("so,op,sp->s", alike, errors[each.rule], alike)
        found.append(np.sqrt(np.maximum(variances, 0) * 2 / np.pi).sum() / 2)
    return float(mean(found))


def _led_to(rules: LiftedRules, asked: Drawn) -> list[list[float]]:
    """A row for each state that may come next, with a 1 for each outcome that leads to it."""
    given = asked.transition
    state = rules.state(given.objects, given.before)
    covering = rules.covering(state, given.action, given.arguments)
    assert covering is not None
    after = [frozenset(changed(given.before, sets).items()) for sets in results(rules, state, *covering)]
    return [[float(other == each) for other in after] for each in dict.fromkeys(after)]


def _told(domain: Domain, seen: Sequence[Drawn]) -> Beliefs:
    """What is believed by who knows which outcome each transition was."""
    numbers = Counter((each.rule, each.outcome) for each in seen)
    counts: dict[int | None, tuple[float, ...]] = {
        number: tuple(float(numbers[number, index]) for index in range(len(rule.outcomes)))
        for number, rule in enumerate(domain.rules)
    }
    estimator = ESTIMATORS[DEFAULT.estimator]
    return maximised(domain, prior_beliefs(domain), counts, SlipRates(), estimator, DEFAULT.m)


def curves(name: str, seed: int, most: int) -> Row:
    """Differences by the estimator, how right its prior was, and how many examples each rule had."""
    rng = np.random.default_rng([seed, 2])
    given = DRAW[name](rng)[0]
    truth = hidden(given, rng)
    source = draw(name, truth, rng)
    asked = [next(source) for _ in range(TESTED)]
    by_rule: dict[int, list[Transition]] = {number: [] for number in {each.rule for each in asked}}
    for _ in range(400 * most):
        if all(len(found) >= most for found in by_rule.values()):
            break
        each = next(source)
        if len(by_rule.get(each.rule, range(most))) < most:
            by_rule[each.rule].append(each.transition)
    asked = [each for each in asked if len(by_rule[each.rule]) >= most]
    row: dict[str, float] = {}
    for prior, start in (("wrong", given), ("right", truth)):
        for number in (n for n in CURVE if n <= most):
            experience = [each for found in by_rule.values() for each in found[:number]]
            evidence = collected(Matcher(start), experience)
            for estimator in ESTIMATORS:
                beliefs = learned_from(start, evidence, Method(estimator)).beliefs
                row[f"{prior} {estimator} {number}"] = difference(truth, taught(start, beliefs), asked)
    return row


def changing(name: str, seed: int, transitions: int) -> Row:
    """Of rules with examples enough on both sides: how many change much and little (by `LITTLE`), and in how
    many a change is found; the same where none changes; how far off its place it is found, in transitions;
    and differences from the later rules with and without forgetting."""
    rng = np.random.default_rng([seed, 3])
    given = DRAW[name](rng)[0]
    first, second = hidden(given, rng), hidden(given, rng)
    old, new = draw(name, first, rng), draw(name, second, rng)
    earlier, more, later = (list(islice(source, transitions)) for source in (old, old, new))
    asked = list(islice(new, TESTED))
    same, changed_midway = ([each.transition for each in (*earlier, *others)] for others in (more, later))
    row = {"alarms": float(len({each.rule for each in _changes(given, same)}))}
    found = _changes(given, changed_midway)
    numbers = [Counter(each.rule for each in part) for part in (earlier, later)]
    row["tested"] = float(len(given.rules))
    for size in ("much", "little"):
        rules = [
            rule
            for rule in range(len(given.rules))
            if min(number[rule] for number in numbers) >= FEWEST
            and (_apart(first.rules[rule], second.rules[rule]) > LITTLE) == (size == "much")
        ]
        row[f"changed {size}"] = float(len(rules))
        row[f"found {size}"] = float(sum(rule in {each.rule for each in found} for rule in rules))
    off = [abs(each.transition - transitions) for each in found]
    row["off"] = float(median(off)) if off else 0.0
    for share in (0.0, FORGETTING):
        beliefs = learn(given, changed_midway, Method(forgetting=share)).beliefs
        row[f"forgetting {share:g}"] = difference(second, taught(given, beliefs), asked)
    return row


def _changes(domain: Domain, transitions: Sequence[Transition]) -> tuple[RuleChange, ...]:
    evidence = collected(Matcher(domain), transitions)
    return changes(evidence, learned_from(domain, evidence, DEFAULT).beliefs)


def _apart(one: Rule, other: Rule) -> float:
    """The total variation of their outcomes."""
    pairs = zip(one.outcomes, other.outcomes, strict=True)
    return float(sum(abs(a.probability - b.probability) for a, b in pairs)) / 2


def _change_table(found: Mapping[tuple[str, int], Row], seeds: Sequence[int]) -> Iterator[str]:
    yield "| domain | found of much changed | of little changed | median off | of unchanged |" + "".join(
        f" forgetting {share:g} |" for share in (0.0, FORGETTING)
    )
    yield "|---|---|---|---|---|---|---|"
    for name in DRAW:
        rows = [found[name, seed] for seed in seeds]
        total = {key: sum(row[key] for row in rows) for key in rows[0]}
        cells = [f"{total[f'found {size}']:g} of {total[f'changed {size}']:g}" for size in ("much", "little")]
        cells += [f"{median(row['off'] for row in rows):g}", f"{total['alarms']:g} of {total['tested']:g}"]
        cells += [_mean([row[f"forgetting {share:g}"] for row in rows]) for share in (0.0, FORGETTING)]
        yield f"| {name} | {' | '.join(cells)} |"


def _table(found: Mapping[tuple[str, int], Row], seeds: Sequence[int]) -> Iterator[str]:
    yield (
        "| domain | before | learned | told | learned / told | the same of the bounds | strict | from right |"
        " more than told | fitted | from right |"
    )
    yield "|---|---|---|---|---|---|---|---|---|---|---|"
    for name in DRAW:
        rows = [found[name, seed] for seed in seeds]
        learned, told = (mean(row[key] for row in rows) for key in ("learned", "told"))
        more = [row["from right"] - row["right and told"] for row in rows]
        cells = [_mean([row[key] for row in rows]) for key in ("before", "learned", "told")]
        bound, when_told = (mean(row[key] for row in rows) for key in ("bound", "bound when told"))
        cells += [f"{learned / told:.2f}", f"{bound / when_told:.2f}"]
        cells += [_mean([row["strict"] for row in rows])]
        cells += [_mean([row["from right"] for row in rows]), _mean(more)]
        cells += [_mean([row[key] for row in rows]) for key in ("fitted", "fitted from right")]
        yield f"| {name} | {' | '.join(cells)} |"


def _curve_table(found: Mapping[tuple[str, int], Row], seeds: Sequence[int]) -> Iterator[str]:
    numbers = sorted({int(key.split()[-1]) for key in found[next(iter(DRAW)), seeds[0]]})
    yield f"| domain | prior | estimator | {' | '.join(map(str, numbers))} |"
    yield f"|---|---|---|{'---|' * len(numbers)}"
    for name in DRAW:
        for prior in ("wrong", "right"):
            for estimator in ESTIMATORS:
                cells = [
                    _mean([found[name, seed][f"{prior} {estimator} {number}"] for seed in seeds])
                    for number in numbers
                ]
                yield f"| {name} | {prior} | {estimator} | {' | '.join(cells)} |"


def _mean(values: Sequence[float]) -> str:
    """With the standard error, where there are several."""
    error = stdev(values) / len(values) ** 0.5 if len(values) > 1 else 0.0
    return f"{mean(values):.4f} ± {error:.4f}"


@dataclass(frozen=True, slots=True)
class Part:
    """What is found of a domain by a seed and a number, and the table of all."""

    row: Callable[[str, int, int], Row]
    table: Callable[[Mapping[tuple[str, int], Row], Sequence[int]], Iterator[str]]


PARTS = {
    "recovery": Part(recovery, _table),
    "curves": Part(curves, _curve_table),
    "changes": Part(changing, _change_table),
}


def main() -> None:
    """Draw what is missing, and print the tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--part", nargs="+", choices=list(PARTS), default=list(PARTS))
    parser.add_argument("--seed", type=int, default=1, help="the first of the seeds")
    parser.add_argument("--seeds", type=int, default=5, help="how many")
    parser.add_argument("--transitions", type=int, default=5000)
    parser.add_argument("--keep", type=Path, metavar="FILE", help="what was drawn before is in it")
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args()
    if options.quick:
        options.seeds, options.transitions = 1, 300
    seeds = range(options.seed, options.seed + options.seeds)
    kept = Kept(options.keep)
    most = CURVE[-1] if options.transitions >= CURVE[-1] else 12
    for part in options.part:
        number = most if part == "curves" else options.transitions
        found = {(name, seed): _row(kept, part, name, seed, number) for name in DRAW for seed in seeds}
        print(*PARTS[part].table(found, seeds), sep="\n")


def _row(kept: Kept, part: str, name: str, seed: int, number: int) -> Row:
    job = [part, name, seed, number]
    for row in kept.rows():
        if row["job"] == job:
            found: Row = row["found"]
            return found
    found = PARTS[part].row(name, seed, number)
    kept.add({"job": job, "found": found})
    print(f"{part}: {name}, seed {seed}", flush=True)
    return found


if __name__ == "__main__":
    main()
