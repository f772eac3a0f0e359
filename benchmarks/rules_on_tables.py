"""Whole rules from the simulated table, beside the shipped ones: python benchmarks/rules_on_tables.py

Carries `--episodes` (50) episodes of `--problem` out on the physical table, the planners in turn, and learns
from what `execute` recorded of them: the probabilities of the shipped rules, whole rules beside those of the
shipped ones that explain it as well, and whole rules from the vocabulary alone. Of `--held-out` (20) more
episodes it prints how likely each makes what happened, in nats for each transition, how far what is
foretold is from what happened (total variation, in the mean), and in how many transitions something
happened that is not foretold. A problem without a table is carried out in the symbolic world.

With `--keep FOLDER` episodes stay there, and are not carried out again. An episode takes about a minute of
CPU, so that the usual 70 take more than an hour. `--quick` takes three of a problem without a table, in
seconds.
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import cleancli
from cleancli.api.experience_paths import experience_files
from cleancli.api.inputs import load_domain
from cleancli.language.model import Domain
from cleancli.learning.experience import Transition, read_experience
from cleancli.learning.structure.arrays import compiled
from cleancli.learning.structure.score import scored, together

PLANNERS = ("prada+", "sst")
"""In turn, since one planner alone does the same in each state; chosen."""


def recorded(folder: Path, problem: str, seeds: Sequence[int], domain: str) -> list[Path]:
    """The run folders of episodes with these seeds, those carried out that are not there yet."""
    found = []
    for seed in seeds:
        own = folder / f"seed{seed}"
        runs = sorted(own.glob("*/run.json"))
        if runs:
            found.append(runs[0].parent)
        else:
            planner = PLANNERS[seed % len(PLANNERS)]
            done = cleancli.execute(domain, problem, seed=seed, planner=planner, runs=own, video=False)
            found.append(Path(done.folder))
    return found


def learned(domain: str, experience: Sequence[Path]) -> Iterator[tuple[str, Domain]]:
    """The domain as it ships, and what was learned in each way."""
    yield "shipped", load_domain(domain).model
    texts: Mapping[str, str] = {
        "shipped, probabilities learned": cleancli.learn(domain, *experience).text,
        "whole rules beside shipped ones": cleancli.learn_structure(domain, *experience).text,
        "whole rules": cleancli.learn_structure(domain, *experience, vocabulary=True).text,
    }
    for name, text in texts.items():
        yield name, load_domain(text).model


def transitions_of(folders: Sequence[Path], domain: Domain) -> list[Transition]:
    """What was recorded in run folders."""
    files, _ = experience_files(folders, domain)
    return [each for file in files for each in read_experience(file.path, domain)]


def row(name: str, domain: Domain, held_out: Sequence[Transition]) -> str:
    """A row of the table."""
    given = compiled(domain, held_out)
    score = together([scored(domain, action, arrays) for action, arrays in given.items()])
    likely = score.log_likelihood / max(score.transitions, 1)
    return (
        f"| {name} | {len(domain.rules)} | {score.literals} | {likely:.3f} | {score.variation:.4f} |"
        f" {score.unforetold} of {score.transitions} |"
    )


def main() -> None:
    """Carry out what is missing, learn, and print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--episodes", type=int, default=50)
    parser.add_argument("--held-out", type=int, default=20, dest="held_out")
    parser.add_argument("--problem", default="two_groups")
    parser.add_argument("--domain", default="cleaning")
    parser.add_argument("--seed", type=int, default=1, help="of the first episode")
    parser.add_argument("--keep", type=Path, metavar="FOLDER")
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args()
    number, more = (2, 1) if options.quick else (options.episodes, options.held_out)
    problem = "three_areas" if options.quick else options.problem
    with tempfile.TemporaryDirectory() as made:
        folder = options.keep or Path(made)
        seeds = range(options.seed, options.seed + number + more)
        folders = recorded(folder, problem, seeds, options.domain)
        vocabulary = load_domain(options.domain).model
        held_out = transitions_of(folders[number:], vocabulary)
        seen = len(transitions_of(folders[:number], vocabulary))
        print(f"{problem}: learned from {seen} transitions of {number} episodes")
        print("| rules | number | literals | nats a transition | TV | not foretold |")
        print("|---|---|---|---|---|---|", flush=True)
        for name, domain in learned(options.domain, folders[:number]):
            print(row(name, domain, held_out), flush=True)


if __name__ == "__main__":
    main()
