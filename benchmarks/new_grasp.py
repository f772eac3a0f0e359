"""How soon a robot gets along with another grasp of the rag: python benchmarks/new_grasp.py [--keep FILE] ...

In the symbolic world. The rules that hold are those of `cleaning` with the shares of outcomes, and the
seconds, that docs/measurements/physics.md reports of the grasps `folded` and `corner`; the robot starts with
the rules that ship. Ten episodes of seven areas each, planned by time, in four ways that meet the same
tables and the same luck: with the shipped rules all the time, with rules that are learned from each action,
by the usual estimator and by `fitted-m`, and with the rules that hold, which is the best that learning could
come to.
Prints the robot's seconds in each episode; from the fifth episode on, the share of the gap between shipped
and true rules that learning closes, and how many times as fast it is, with intervals of Student's t.

`--told N` adds a robot that begins with so many examples of each rule and knows which outcome each was, and
learns nothing more: whether ten episodes can tell enough. `--untimed` adds one that learns by `fitted-m` how
likely outcomes are, and not how long actions take.

About a quarter of an hour of CPU for 20 seeds. With --keep each series is a line of FILE, and not run again.
`--quick` runs two episodes of one seed, in about ten seconds.
"""

from __future__ import annotations

import argparse
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from statistics import mean

import numpy as np
from instances import as_shipped
from kept import Kept
from strategies import interval

from cleancli.execution.events import Checkpoint
from cleancli.execution.loop import clean
from cleancli.execution.session import symbolic_session
from cleancli.execution.setup import EpisodeOptions, within_reach
from cleancli.execution.trials import GATHERING
from cleancli.language.find import find
from cleancli.language.load import load_domain, read_source
from cleancli.language.model import Action, Assign, Domain, Literal, Outcome, Rule
from cleancli.learning.estimate import ESTIMATORS, FITTED
from cleancli.learning.evidence import Evidence
from cleancli.learning.expectation import SlipRates, maximised, nothing_counted, prior_beliefs, told
from cleancli.learning.method import DEFAULT, Method
from cleancli.scene.robots import ARMS
from learning import taught
from planning import layout

PAGE = Path(__file__).resolve().parents[1] / "docs" / "measurements" / "physics.md"
GRASPS = ("folded", "corner")
KINDS = ("shipped", "learned", "fitted", "true")
TOLD, UNTIMED = "told ", "fitted, untimed"
LEARNING: Mapping[str, Method] = {"learned": DEFAULT, "fitted": Method(FITTED), UNTIMED: Method(FITTED)}
LATE = 5
"""The episode from which on learning counts as done; the first is 1."""

Shares = Mapping[tuple[str, str, str], tuple[float, float, float, float]]
"""By action, compact or scattered, and grasp: none left, some left, spread out, and seconds."""


def measured() -> Shares:
    """What docs/measurements/physics.md reports of each action."""
    share = r"([\d.]+) \| "
    row = re.compile(rf"\| (\w+) \| (compact|scattered) \| (\w+) \| {share * 3}(.*)")
    found = {}
    for line in PAGE.read_text(encoding="utf-8").splitlines():
        if (match := row.match(line)) is not None:
            seconds = float(match[7].split(" | ")[3])
            found[match[1], match[2], match[3]] = (float(match[4]), float(match[5]), float(match[6]), seconds)
    return found


def true_rules(domain: Domain, shares: Shares, grasp: str) -> Domain:
    """The domain with the shares of outcomes, and the seconds, of a grasp."""
    rules = tuple(_true_rule(rule, shares, grasp) for rule in domain.rules)
    return replace(domain, rules=rules, actions=tuple(_timed(each, shares, grasp) for each in domain.actions))


def _timed(action: Action, shares: Shares, grasp: str) -> Action:
    """The mean for compact and scattered dirt; as it ships where the page has no row."""
    rows = [row[3] for (name, _, by), row in shares.items() if (name, by) == (action.name, grasp)]
    return replace(action, duration=mean(rows)) if rows else action


def _true_rule(rule: Rule, shares: Shares, grasp: str) -> Rule:
    scattered = any(
        isinstance(p, Literal) and p.symbol == "scattered" and True in p.values for p in rule.condition
    )
    row = shares.get((rule.action, "scattered" if scattered else "compact", grasp))
    if row is None:
        return rule
    ends = [_end(rule, outcome) for outcome in rule.outcomes]
    chances = [0.0] * len(ends)
    for end, share in zip(("none", "some", "spread"), row[:3], strict=True):
        # An end that the rule does not model is noise to it.
        own = [index for index, each in enumerate(ends) if each == end] or [len(ends) - 1]
        total = sum(float(rule.outcomes[index].probability) for index in own)
        for index in own:
            chances[index] += share * float(rule.outcomes[index].probability) / total
    exact = [Fraction(round(10_000 * chance), 10_000) for chance in chances]
    exact[-1] += 1 - sum(exact)
    outcomes = zip(rule.outcomes, exact, strict=True)
    return replace(
        rule, outcomes=tuple(replace(o, probability=chance, is_rest=False) for o, chance in outcomes)
    )


def _end(rule: Rule, outcome: Outcome) -> str:
    """Which of the page's ends an outcome of a rule is: spread out, none left, or some left. None is left
    where all areas are gone; where they are joined, all but the last; where one is grouped, if it is
    compact."""
    effects = {(e.symbol, e.terms, e.value) for e in outcome.effects if isinstance(e, Assign)}
    areas = rule.variables
    if rule.action == "groupScattered":
        wanted = {("scattered", areas, False)}
    else:
        gone = areas[:-1] if rule.action in GATHERING else areas
        wanted = {("dirt", (area,), False) for area in gone}
    if any(symbol == "scattered" and value is True for symbol, _, value in effects):
        return "spread"
    return "none" if wanted <= effects else "some"


def told_rules(shipped: Domain, true: Domain, examples: int, seed: int) -> Domain:
    """What the shipped rules become by so many examples of each rule, drawn from the true ones, where it is
    told which outcome each was; durations are the true ones."""
    rng = np.random.default_rng([seed, examples])
    counts = dict(nothing_counted(shipped))
    for number, rule in enumerate(true.rules):
        chances = [float(outcome.probability) for outcome in rule.outcomes]
        counts[number] = tuple(map(float, rng.multinomial(examples, chances)))
    own, estimator = told(shipped, counts, DEFAULT.m), ESTIMATORS[FITTED]
    beliefs = maximised(shipped, prior_beliefs(shipped), counts, SlipRates(), estimator, DEFAULT.m, own)
    return replace(taught(shipped, beliefs), actions=true.actions)


def series(grasp: str, kind: str, seed: int, episodes: int, areas: int, samples: int) -> list[float]:
    """The robot's seconds in each episode."""
    shipped = within_reach(load_domain(read_source(find("cleaning", "domains"))), ARMS["gantry"])
    true = true_rules(shipped, measured(), grasp)
    known, found = shipped, list[float]()
    if kind == "true":
        known = true
    elif kind == UNTIMED:
        fixed = tuple(replace(action, duration_fixed=True) for action in shipped.actions)
        known = replace(shipped, actions=fixed)
    elif kind.startswith(TOLD):
        known = told_rules(shipped, true, int(kind.removeprefix(TOLD)), seed)
    evidence = Evidence()
    for number in range(episodes):
        options = EpisodeOptions(
            samples=samples,
            seed=1000 * seed + number,
            by_time=True,
            learning=LEARNING.get(kind),
        )
        problem = as_shipped(layout(areas, 1000 * seed + number), shipped)
        session = symbolic_session(known, problem, options, acting=true)
        for event in clean(replace(session.setup, evidence=evidence), session.cell):
            if isinstance(event, Checkpoint):
                evidence = event.state.evidence
        found.append(session.cell.clock)
    return found


def _lines(grasp: str, found: Mapping[str, Sequence[Sequence[float]]]) -> Iterator[str]:
    """A row for each kind with its seconds by episode, and what learning came to."""
    for kind, runs in found.items():
        cells = [f"{mean(run[number] for run in runs):.1f}" for number in range(len(runs[0]))]
        yield f"| {grasp} | {kind} | {' | '.join(cells)} |"
    late = min(LATE, len(found["true"][0])) - 1
    ends = {kind: [mean(run[late:]) for run in runs] for kind, runs in found.items()}
    means = {kind: mean(seconds) for kind, seconds in ends.items()}
    gap = means["shipped"] - means["true"]
    yield f"{grasp}, from episode {late + 1}:"
    for kind, seconds in ends.items():
        closed = f"{(means['shipped'] - means[kind]) / gap:.0%}" if gap > 0 else "none to close"
        less = interval([one - other for one, other in zip(ends["shipped"], seconds, strict=True)])
        faster = means["shipped"] / means[kind]
        yield (
            f"{kind}: {interval(seconds)} s, {less} s less than with the shipped rules,"
            f" {faster:.2f} times as fast; of the gap closed: {closed}"
        )


def main() -> None:
    """Run what is missing, and print the tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--grasp", nargs="+", choices=GRASPS, default=list(GRASPS))
    parser.add_argument("--seed", type=int, default=1, help="the first of the seeds")
    parser.add_argument("--seeds", type=int, default=20, help="how many")
    parser.add_argument("--told", nargs="*", type=int, default=[], metavar="N", help="examples of each rule")
    parser.add_argument("--untimed", action="store_true", help="durations stay as shipped")
    parser.add_argument("--episodes", type=int, default=10)
    parser.add_argument("--areas", type=int, default=7)
    parser.add_argument("--samples", type=int, default=2000, help="of the planner")
    parser.add_argument("--keep", type=Path, metavar="FILE", help="series run before are in it")
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args()
    if options.quick:
        options.grasp, options.seeds, options.episodes, options.areas = ["folded"], 1, 2, 4
    kinds = [*KINDS, *(f"{TOLD}{number}" for number in options.told), *([UNTIMED] if options.untimed else [])]
    kept = Kept(options.keep)
    known = {tuple(row["job"]): row["seconds"] for row in kept.rows()}
    results: dict[str, dict[str, list[list[float]]]] = {}
    for seed in range(options.seed, options.seed + options.seeds):
        for grasp in options.grasp:
            for kind in kinds:
                job = (grasp, kind, seed, options.episodes, options.areas, options.samples)
                if job not in known:
                    known[job] = series(*job)
                    kept.add({"job": job, "seconds": known[job]})
                    print(f"{grasp}, {kind}, seed {seed}: {mean(known[job]):.1f} s an episode", flush=True)
                results.setdefault(grasp, {}).setdefault(kind, []).append(known[job])
    for grasp, found in results.items():
        print(*_lines(grasp, found), sep="\n")


if __name__ == "__main__":
    main()
