"""`cleancli show`: what a domain declares, and how much of it a problem uses."""

from __future__ import annotations

import io
import json
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import click
from rich.console import Console, RenderableType
from rich.table import Table
from rich.text import Text
from rich.tree import Tree

from cleancli.cli import options
from cleancli.cli.command_table import command_of
from cleancli.cli.inputs import open_loaded
from cleancli.cli.observe import open_both
from cleancli.compiler.ground import ground
from cleancli.compiler.task import Task, horizon_text
from cleancli.language.diagnostics.plural import plural
from cleancli.language.load import located_in
from cleancli.language.model import Action, DerivedPredicate, Domain, Knowledge, Problem, Rule, Symbol, Type
from cleancli.language.printing.printer import (
    print_condition,
    print_fraction,
    print_price,
    print_reference,
    print_result,
    print_signature,
    symbols_of,
)
from cleancli.planning.evaluation.coverage import coverage

_NO_EDGE = 10_000


@dataclass(frozen=True, slots=True)
class Sizes:
    """How large a problem is once it is grounded: `rules` counts groundings by a rule's number in the domain,
    `actions` those by name; `coverage` is that of `samples` sequences (eq. 3)."""

    problem: str
    objects: int
    variables: int
    rules: Counter[int]
    actions: Counter[str]
    horizon: int | None
    samples: int
    coverage: float


@command_of("show")
@options.samples("Action sequences whose coverage is told (n in eq. 3).", 10_000)
@options.as_json("Print everything as JSON.")
def command(domain: str, problem: str | None, samples: int, as_data: bool) -> None:
    """Show the types of DOMAIN as a tree, its symbols, and the rules of each action with their outcomes.

    With PROBLEM, also how many groundings each rule and action has there (those that can ever apply and
    change something), and which share of the plan space the planner's samples cover.
    """
    if problem is None:
        model = open_loaded(domain).model
        sizes = None
    else:
        sources, model, given = open_both(domain, problem)
        with located_in(*sources):
            sizes = _sizes(given, model, ground(model, given), samples)
    if as_data:
        click.echo(json.dumps(_as_data(model, sizes), indent=2))
    else:
        _print(model, sizes)


def _sizes(problem: Problem, domain: Domain, task: Task, samples: int) -> Sizes:
    return Sizes(
        problem.name,
        len(problem.objects) + len(domain.constants),
        len(task.variables),
        Counter(rule.rule for rule in task.rules),
        Counter(action.name for action in task.actions),
        task.steps,
        samples,
        coverage(task, samples),
    )


# ---- for people


def _print(domain: Domain, sizes: Sizes | None) -> None:
    """As wide as the terminal; a file or a pipe has no edge to wrap at."""
    if sys.stdout.isatty():
        console = Console(highlight=False)
        for part in _parts(domain, sizes):
            console.print(part)
        return
    plain = Console(file=io.StringIO(), highlight=False, color_system=None, width=_NO_EDGE)
    with plain.capture() as text:
        for part in _parts(domain, sizes):
            plain.print(part)
    click.echo("\n".join(line.rstrip() for line in text.get().splitlines()))


def _parts(domain: Domain, sizes: Sizes | None) -> Iterator[RenderableType]:
    yield Text(f"domain {domain.name}", style="bold")
    tree = Tree("types", guide_style="dim")
    _grow(tree, domain.types, None)
    yield tree
    yield from _listed("constants", [f"{c.name} - {c.type}" for c in domain.constants])
    yield from _listed("symbols", [_symbol(symbol) for symbol in domain.symbols])
    yield from _listed("derived", [_derived(definition, domain) for definition in domain.derived])
    yield from _listed("counts", [count.name for count in domain.counts])
    yield from _listed(
        "parameters", [f"{p.name} = {print_fraction(p.probability)}" for p in domain.parameters]
    )
    yield from _listed("learned", [] if domain.learned is None else list(_learned(domain.learned)))
    for action in domain.actions:
        yield Text("")
        yield Text(_action(action, sizes), style="bold")
        yield _rules(domain, action, sizes)
    if sizes is not None:
        yield Text("")
        yield Text(
            f"problem {sizes.problem}: {plural(sizes.objects, 'object')},"
            f" {plural(sizes.variables, 'state variable')}, {plural(sizes.actions.total(), 'action')},"
            f" {plural(sizes.rules.total(), 'rule')}; horizon {horizon_text(sizes.horizon)},"
            f" coverage {sizes.coverage:z.3g} by {plural(sizes.samples, 'sample')} (eq. 3)"
        )


def _grow(tree: Tree, types: Sequence[Type], parent: str | None) -> None:
    for child in types:
        if child.parent == parent:
            _grow(tree.add(child.name), types, child.name)


def _listed(title: str, items: Sequence[str]) -> Iterator[RenderableType]:
    if items:
        yield Text(title)
        yield from (Text(f"  {item}") for item in items)


def _rules(domain: Domain, action: Action, sizes: Sizes | None) -> Table:
    table = Table(box=None, padding=(0, 2, 0, 2), show_edge=False)
    table.add_column("rule", no_wrap=True)
    if sizes is not None:
        table.add_column("groundings", justify="right")
    table.add_column("chance", justify="right", no_wrap=True)
    table.add_column("what happens")
    for number, rule in enumerate(domain.rules):
        if rule.action == action.name:
            for row in _rows(domain, rule, None if sizes is None else sizes.rules[number]):
                table.add_row(*row)
    return table


def _rows(domain: Domain, rule: Rule, groundings: int | None) -> Iterator[list[Text]]:
    """The rule's name with its condition, and below it a row for each outcome."""
    symbols = symbols_of(domain)
    counted = [] if groundings is None else [str(groundings)]
    condition = print_condition(rule.condition, symbols)
    yield [Text(cell) for cell in (rule.name, *counted, "", f"when {condition}" if condition else "always")]
    for reference in rule.references:
        yield [Text(cell) for cell in ("", *("" for _ in counted), "", print_reference(reference, symbols))]
    for outcome in rule.outcomes:
        chance, result = print_fraction(outcome.probability), print_result(outcome, symbols)
        yield [Text(cell) for cell in ("", *("" for _ in counted), chance, result)]


def _symbol(symbol: Symbol) -> str:
    values = "" if symbol.is_predicate else f": {' < '.join(map(str, symbol.values))}"
    marks = ", ".join(word for word in ("symmetric", "static") if getattr(symbol, word))
    return f"{print_signature(symbol.name, symbol.parameters)}{values}{f' [{marks}]' if marks else ''}"


def _derived(definition: DerivedPredicate, domain: Domain) -> str:
    meaning = (
        print_condition(definition.condition, symbols_of(domain))
        if definition.closure is None
        else f"closure {definition.closure}"
    )
    return f"{print_signature(definition.name, definition.parameters)} := {meaning}"


def _learned(learned: Knowledge) -> Iterator[str]:
    forgotten = f", forgetting {learned.forgetting:g}" if learned.forgetting else ""
    yield f"estimator {learned.estimator}, m {learned.m:g}, match {learned.match}{forgotten}"
    for each in learned.experience:
        yield f"{plural(each.transitions, 'transition')} of {each.name} (sha256 {each.sha256})"


def _action(action: Action, sizes: Sizes | None) -> str:
    duration = "" if action.duration is None else f"  {action.duration:g} s"
    if action.cost:
        duration += f"  cost {print_price(action.cost)}"
    counted = "" if sizes is None else f"  {plural(sizes.actions[action.name], 'grounding')}"
    return f"{print_signature(action.name, action.parameters)}{duration}{counted}"


# ---- for programs


def _as_data(domain: Domain, sizes: Sizes | None) -> dict[str, object]:
    data: dict[str, object] = {
        "domain": domain.name,
        "types": {type_.name: type_.parent for type_ in domain.types},
        "constants": {constant.name: constant.type for constant in domain.constants},
        "symbols": [_symbol(symbol) for symbol in domain.symbols],
        "derived": [_derived(definition, domain) for definition in domain.derived],
        "counts": [count.name for count in domain.counts],
        "parameters": {p.name: float(p.probability) for p in domain.parameters},
        "learned": None if domain.learned is None else _learned_data(domain.learned),
        "actions": [_action_data(domain, action, sizes) for action in domain.actions],
    }
    if sizes is not None:
        data["problem"] = {
            "name": sizes.problem,
            "objects": sizes.objects,
            "variables": sizes.variables,
            "actions": sizes.actions.total(),
            "rules": sizes.rules.total(),
            "horizon": sizes.horizon,
            "samples": sizes.samples,
            "coverage": sizes.coverage,
        }
    return data


def _learned_data(learned: Knowledge) -> dict[str, object]:
    return {
        "estimator": learned.estimator,
        "m": learned.m,
        "match": learned.match,
        "forgetting": learned.forgetting,
        "experience": [
            {"name": each.name, "sha256": each.sha256, "transitions": each.transitions}
            for each in learned.experience
        ],
    }


def _action_data(domain: Domain, action: Action, sizes: Sizes | None) -> dict[str, object]:
    rules = [(number, rule) for number, rule in enumerate(domain.rules) if rule.action == action.name]
    return {
        "name": action.name,
        "parameters": {variable.name: variable.type for variable in action.parameters},
        "duration": action.duration,
        "cost": print_price(action.cost) if action.cost else None,
        **({} if sizes is None else {"groundings": sizes.actions[action.name]}),
        "rules": [_rule_data(domain, number, rule, sizes) for number, rule in rules],
    }


def _rule_data(domain: Domain, number: int, rule: Rule, sizes: Sizes | None) -> dict[str, object]:
    symbols = symbols_of(domain)
    return {
        "name": rule.name,
        "when": print_condition(rule.condition, symbols),
        **({} if sizes is None else {"groundings": sizes.rules[number]}),
        "outcomes": [
            {"probability": float(outcome.probability), "result": print_result(outcome, symbols)}
            for outcome in rule.outcomes
        ],
    }
