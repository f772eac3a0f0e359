"""`cleancli plan`: the best sequence of actions found for a problem, or for a scene after one look at it."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator
from contextlib import contextmanager

import click

from cleancli.cli.completion import domains, problems
from cleancli.cli.inputs import located_in, open_domain, open_problem
from cleancli.cli.live import working
from cleancli.cli.seen import look
from cleancli.compiler.ground import ground
from cleancli.language.model import Problem
from cleancli.planning.plan import Options, Plan
from cleancli.planning.prepared import prepare
from cleancli.planning.table import PLANNERS, Planner
from cleancli.scene.model import Scene


@click.command("plan", short_help="Plan for a problem, or for what the camera sees of a scene.")
@click.argument("domain", shell_complete=domains)
@click.argument("problem", shell_complete=problems)
@click.option("--planner", type=click.Choice(list(PLANNERS)), help="[default: the problem's, or prada]")
@click.option(
    "--samples",
    type=click.IntRange(min=1),
    help="Action sequences to draw (n in eq. 3). [default: the problem's, or 10000]",
)
@click.option(
    "--seed",
    type=click.IntRange(min=0),
    help="Seed of all randomness. [default: the problem's or the scene's, or 1]",
)
@click.option("--json", "as_data", is_flag=True, help="Print the plan as JSON.")
def command(
    domain: str, problem: str, planner: str | None, samples: int | None, seed: int | None, as_data: bool
) -> None:
    """Plan with the rules of DOMAIN for PROBLEM.

    For a scene, the simulated camera looks at the table once, and the plan is for what perception reports.
    """
    _, sources, model = open_domain(domain)
    given = open_problem(problem, model)
    seconds: dict[str, float] = {}
    if isinstance(given, Scene):
        seed = given.seed if seed is None else seed
        with _timed(seconds, "look"), located_in(*sources), working("looking at the table"):
            model, given = look(model, given, seed)
    with _timed(seconds, "ground"), located_in(*sources):
        task = ground(model, given)
    with working("planning (the first run compiles the planner)"):
        result = _planner(planner, given)(prepare(task), _options(samples, seed, given))
    seconds |= result.seconds
    if as_data:
        click.echo(json.dumps(_as_data(given, result, seconds), indent=2))
    else:
        _print(given, result, seconds)


def _planner(asked: str | None, problem: Problem) -> Planner:
    """The planner that the command line names, or else the problem; raises UsageError for an unknown one."""
    name = asked or problem.planner or "prada"
    if name not in PLANNERS:
        known = ", ".join(PLANNERS)
        raise click.UsageError(f"the problem asks for the planner `{name}`; there is {known}")
    return PLANNERS[name]


def _options(samples: int | None, seed: int | None, problem: Problem) -> Options:
    """What the command line says, or else the problem, or else the usual."""
    usual = Options(seed=1)
    return Options(
        next(n for n in (samples, problem.samples, usual.samples) if n is not None),
        next(n for n in (seed, problem.seed, usual.seed) if n is not None),
    )


@contextmanager
def _timed(seconds: dict[str, float], phase: str) -> Iterator[None]:
    started = time.perf_counter()
    yield
    seconds[phase] = time.perf_counter() - started


def _as_data(problem: Problem, plan: Plan, seconds: dict[str, float]) -> dict[str, object]:
    return {
        "problem": problem.name,
        "planner": plan.planner,
        "plan": [str(action) for action in plan.actions],
        "value": plan.value,
        "samples": plan.samples,
        "horizon": plan.horizon,
        "coverage": plan.coverage,
        "seconds": seconds,
    }


def _print(problem: Problem, plan: Plan, seconds: dict[str, float]) -> None:
    if not plan.actions:
        click.echo("nothing worth doing")
    for number, action in enumerate(plan.actions, start=1):
        click.echo(f"{number:3}. {action}")
    click.echo(
        f"value {plan.value:.4f} by {plan.planner}, {plan.samples} samples, horizon {plan.horizon},"
        f" {len(problem.objects)} objects, coverage {plan.coverage:.3g}"
    )
    click.echo("seconds: " + ", ".join(f"{phase} {spent:.3f}" for phase, spent in seconds.items()))
