"""`cleancli simulate`: what planners achieve in the symbolic world, over many episodes."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict

import click

from cleancli.cli.completion import domains, problems
from cleancli.cli.inputs import open_domain
from cleancli.cli.observe import open_both
from cleancli.cli.progress import counted
from cleancli.cli.unreached import tell_unreached
from cleancli.cli.usage import usage_errors
from cleancli.cli.views.simulated import as_data, print_summaries
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.find import find
from cleancli.language.load import located_in, read_source
from cleancli.planning.asked import planner_named, planner_options
from cleancli.planning.refusal import planning_refused
from cleancli.planning.registry import PLANNERS
from cleancli.simulation.batch import Batch, spread
from cleancli.simulation.compatibility import refuse_unlike
from cleancli.simulation.episode import Episode, EpisodeLimits
from cleancli.simulation.summary import summarized


@click.command("simulate", short_help="How well planners do in the symbolic world, over many episodes.")
@click.argument("domain", shell_complete=domains)
@click.argument("problem", shell_complete=problems)
@click.option(
    "--planner",
    "planners",
    type=click.Choice(list(PLANNERS)),
    multiple=True,
    help="May be repeated: all meet the same draws. [default: the problem's, or prada+]",
)
@click.option("--episodes", type=click.IntRange(min=1), default=100, show_default=True)
@click.option(
    "--world",
    metavar="DOMAIN",
    help="The rules by which the world acts and pays. [default: those of DOMAIN]",
    shell_complete=domains,
)
@click.option(
    "--samples",
    type=click.IntRange(min=1),
    help="What a planner draws for a plan. [default: the problem's, or 10000]",
)
@click.option(
    "--seed", type=click.IntRange(min=0), help="Seed of all randomness. [default: the problem's, or 1]"
)
@click.option(
    "--time-limit", type=click.FloatRange(min=0, min_open=True), help="Seconds for a plan; see the docs."
)
@click.option(
    "--max-actions",
    type=click.IntRange(min=0),
    default=60,
    show_default=True,
    help="Stop an episode after so many actions.",
)
@click.option(
    "--commit",
    type=click.IntRange(min=1),
    default=1,
    show_default=True,
    help="Actions of a plan to do before planning again (§4.2.4).",
)
@click.option("--jobs", type=click.IntRange(min=1), default=1, show_default=True, help="Processes.")
@click.option(
    "--objective",
    type=click.Choice(["reward", "time"]),
    default="reward",
    show_default=True,
    help="What discounts later rewards: the number of actions before, or their duration.",
)
@click.option("--json", "as_json", is_flag=True, help="Print everything as JSON, episode by episode.")
@usage_errors()
def command(
    domain: str,
    problem: str,
    planners: tuple[str, ...],
    episodes: int,
    world: str | None,
    samples: int | None,
    seed: int | None,
    time_limit: float | None,
    max_actions: int,
    commit: int,
    jobs: int,
    objective: str,
    as_json: bool,
) -> None:
    """Simulate episodes of PROBLEM: plan with the rules of DOMAIN, do the first actions, plan again.

    What comes of an action is drawn from the rules. An episode ends when the goal holds, when nothing is left
    of the count, when the planner finds nothing worth doing, or after --max-actions.
    """
    sources, model, given = open_both(domain, problem)
    world_model, world_sources = model, sources
    if world is not None:
        _, world_sources, world_model = open_domain(world)
        refuse_unlike(model, world_model, given, sources, world_sources)
    setup = Batch(
        model,
        world_model,
        given,
        tuple(dict.fromkeys(planners)) or (planner_named(None, given),),
        planner_options(
            given, samples=samples, seed=seed, time_limit=time_limit, threads=None if jobs == 1 else 1
        ),
        EpisodeLimits(max_actions, commit),
        objective == "time",
    )
    texts = (*sources, *world_sources, read_source(find(problem, "problems")))
    tell_unreached(texts, model, given)
    with located_in(*texts):
        found = _episodes(setup, episodes, jobs, texts)
    summaries = [
        summarized(name, each, found[0] if each is not found[0] else None)
        for name, each in zip(setup.planners, found, strict=True)
    ]
    if as_json:
        click.echo(json.dumps(as_data(setup, summaries, found, asdict(setup.options)), indent=2))
    else:
        print_summaries(summaries)


def _episodes(
    setup: Batch, episodes: int, jobs: int, sources: Sequence[Source]
) -> tuple[tuple[Episode, ...], ...]:
    """The episodes of each planner, in their order."""
    with planning_refused(sources):
        found = list(counted("simulating", spread(setup, episodes, jobs), episodes))
    found.sort(key=lambda each: each[0].number)
    return tuple(zip(*found, strict=True))
