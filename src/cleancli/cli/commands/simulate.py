"""`cleancli simulate`: what planners achieve in the symbolic world, over many episodes."""

from __future__ import annotations

from pathlib import Path

import click

from cleancli.api.asked import Asked
from cleancli.api.simulated_experience import write_experience
from cleancli.api.simulations import PLAN, STRATEGIES, Acts, batch, simulation_result
from cleancli.cli import options
from cleancli.cli.command_table import command_of
from cleancli.cli.completion import domains
from cleancli.cli.inputs import open_given, open_loaded
from cleancli.cli.progress import counted, working
from cleancli.cli.unreached import tell_unreached
from cleancli.cli.usage import usage_errors
from cleancli.cli.views.simulated import echo_simulation
from cleancli.language.load import located_in
from cleancli.learning.method import KNOWN
from cleancli.planning.objective import OBJECTIVES
from cleancli.planning.refusal import planning_refused
from cleancli.planning.registry import PLANNERS
from cleancli.simulation.episode import EpisodeLimits


@command_of("simulate")
@click.option(
    "--planner",
    "planners",
    type=click.Choice(list(PLANNERS)),
    multiple=True,
    help="May be repeated: all meet the same draws. [default: the problem's, or prada+]",
)
@click.option(
    "--strategy",
    type=click.Choice(STRATEGIES),
    default=PLAN,
    show_default=True,
    help="Plan by rules, explore to learn them, or act at random.",
)
@click.option(
    "--known",
    type=click.IntRange(min=0),
    metavar="T",
    help=f"Explore until rules are seen T times. [default: {KNOWN}]",
)
@click.option("--episodes", type=click.IntRange(min=1), default=100, show_default=True)
@click.option(
    "--world",
    metavar="DOMAIN",
    help="The rules by which the world acts and pays. [default: those of DOMAIN]",
    shell_complete=domains,
)
@options.samples("What a planner draws for a plan. [default: the problem's, or 10000]")
@options.seed(usual="the problem's, or 1")
@options.time_limit("a plan")
@options.max_actions("Stop an episode after so many actions.")
@click.option(
    "--commit",
    type=click.IntRange(min=1),
    default=1,
    show_default=True,
    help="Actions of a plan to do before planning again (§4.2.4).",
)
@options.jobs("Processes.")
@options.objective(OBJECTIVES)
@options.named()
@click.option("--think", is_flag=True, help="The seconds that a planner takes count as robot time.")
@click.option(
    "--record",
    type=options.FILE,
    help="Write what was done into a new experience file, for `cleancli learn`.",
)
@options.as_json("Print everything as JSON, episode by episode.")
@usage_errors()
def command(
    domain: str,
    problem: str,
    planners: tuple[str, ...],
    strategy: str,
    known: int | None,
    episodes: int,
    world: str | None,
    samples: int | None,
    seed: int | None,
    time_limit: float | None,
    max_actions: int,
    commit: int,
    jobs: int,
    objective: str | None,
    named: tuple[str, ...],
    think: bool,
    record: Path | None,
    as_data: bool,
) -> None:
    """Simulate episodes of PROBLEM: plan with the rules of DOMAIN, do the first actions, plan again.

    What comes of an action is drawn from the rules. An episode ends when the goal holds, when nothing is left
    of the count, when the planner finds nothing worth doing, or after --max-actions.
    """
    if record is not None and record.exists():
        raise click.UsageError(f"--record {record}: the file exists, and nothing is written over")
    given = open_given(domain, problem)
    acting = given.domain if world is None else open_loaded(world)
    acts = Acts(strategy, known, jobs)
    asked = Asked(samples, seed, time_limit, None if jobs == 1 else 1, objective, named)
    with working("looking at the table", quiet=not given.is_scene):
        setup = batch(given, acting, planners, asked, EpisodeLimits(max_actions, commit, think=think), acts)
    texts = (*given.domain.sources, *acting.sources, given.source)
    tell_unreached(texts, setup.domain if acts.strategy == PLAN else setup.world, setup.problem)
    with located_in(*texts), planning_refused(texts):
        found = counted("simulating", acts.episodes(setup, episodes), episodes)
        result = simulation_result(setup, strategy, found)
    if record is not None:
        write_experience(setup, result, record)
    echo_simulation(result, as_data)
