"""`cleancli learn`: what experience says about a domain's probabilities, as a diff or in place."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import click

from cleancli.cli.completion import domains
from cleancli.cli.echo import echo
from cleancli.cli.files import echo_difference
from cleancli.cli.inputs import may_include_outside, open_domain
from cleancli.cli.progress import working
from cleancli.files.replace import Replacement, write_all
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.plural import plural
from cleancli.language.diagnostics.text_edit import Edit, apply_edits
from cleancli.language.load import checked_domain, located_in
from cleancli.language.model import Domain
from cleancli.learning.estimate import DEFAULT_M, ESTIMATORS
from cleancli.learning.experience import Transition, read_experience
from cleancli.learning.learn import Learned, edits, is_written, learn
from cleancli.learning.match import outcomes_of
from cleancli.recording.folder import EXPERIENCE, check_folder


@click.command("learn", short_help="Improve a domain's probabilities from recorded experience.")
@click.argument("domain", shell_complete=domains)
@click.argument("experience", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option(
    "--estimator",
    type=click.Choice(list(ESTIMATORS)),
    default="decreasing-m",
    show_default=True,
    help="How counts and prior are combined: eq. 5 or eq. 4.",
)
@click.option(
    "--m",
    type=click.FloatRange(min=0),
    default=DEFAULT_M,
    show_default=True,
    help="Weight of the prior, in examples.",
)
@click.option(
    "--write", is_flag=True, help="Change the probabilities in the domain's file and those it includes."
)
@click.option("--json", "as_data", is_flag=True, help="Print what was learned as JSON.")
def command(
    domain: str, experience: tuple[Path, ...], estimator: str, m: float, write: bool, as_data: bool
) -> None:
    """Learn the probabilities of DOMAIN from EXPERIENCE: experience.jsonl files, or run folders.

    Prints the change as a diff; only --write changes files. The prior stays in the file beside the learned
    number, so that learning again from the same experience changes nothing: give every file that shall count.
    """
    path, sources, model = open_domain(domain)
    if write and not Path(domain).is_file():
        raise click.UsageError(f"`{domain}` ships with cleancli: copy {path}, and learn into your copy")
    transitions = _Transitions(experience, model)
    with located_in(*sources), working("learning"):
        learned = learn(model, transitions.each(), ESTIMATORS[estimator], m)
    texts = _edited(sources, edits(model, sources, learned))
    checked_domain(texts[sources[0].path], may_include_outside(), lambda file: texts[str(file)]).get()
    if as_data:
        click.echo(json.dumps([_as_data(model, entry) for entry in learned], indent=2))
    else:
        _print_difference(sources, texts)
        _print(model, learned, transitions.number)
    if write:
        changed = [source for source in sources if texts[source.path].text != source.text]
        write_all(Replacement(Path(source.path), texts[source.path].text, source.text) for source in changed)
        for source in changed:
            echo(f"wrote {source.path}", err=as_data)


class _Transitions:
    """Those of some files, as they are read; `number` is how many there were."""

    def __init__(self, files: Sequence[Path], domain: Domain) -> None:
        self._files, self._domain = tuple(map(_experience_file, files)), domain
        self.number = 0

    def each(self) -> Iterator[Transition]:
        """Read all, one after the other. Raises Refused."""
        for file in self._files:
            for transition in read_experience(file, self._domain):
                self.number += 1
                yield transition


def _edited(sources: Sequence[Source], changes: Sequence[Edit]) -> dict[str, Source]:
    """The texts of the domain, with those that it includes, after the edits of each."""
    return {
        source.path: Source(
            source.path,
            apply_edits(source.text, [edit for edit in changes if edit.span.path == source.path]),
        )
        for source in sources
    }


def _experience_file(path: Path) -> Path:
    """Raises Refused (E705) for a run's folder that is not as a run leaves it."""
    if not path.is_dir():
        return path
    check_folder(path)
    return path / EXPERIENCE


def _print_difference(sources: Sequence[Source], texts: Mapping[str, Source]) -> None:
    for source in sources:
        echo_difference(source, texts[source.path].text, "learned")


def _print(model: Domain, learned: Sequence[Learned], transitions: int) -> None:
    has_default = all(map(is_written, model.default))
    of_rules = [entry for entry in learned if entry.rule is not None or has_default]
    examples = sum(sum(entry.seen) + entry.unexplained for entry in of_rules)
    echo(
        f"{plural(transitions, 'transition')}, {plural(examples, 'example')}"
        f" for {len(of_rules)} of {plural(len(model.rules) + has_default, 'rule')}"
    )
    for entry in learned:
        if entry.rule is None and not has_default:
            uncovered = sum(entry.seen) + entry.unexplained
            echo(
                f"{plural(uncovered, 'transition')} that no rule covers: the domain has no `default`, and so"
                " expects nothing to happen there"
            )
        if entry.unexplained:
            echo(
                f"{_rule_name(model, entry)}: {plural(entry.unexplained, 'result')} that no outcome explains,"
                " and no noise outcome to count them to"
            )


def _as_data(model: Domain, entry: Learned) -> dict[str, object]:
    return {
        "rule": _rule_name(model, entry),
        "examples": sum(entry.seen),
        "unexplained": entry.unexplained,
        "outcomes": [
            {
                "kind": outcome.kind.value,
                "prior": float(prior),
                "probability": float(probability),
                "seen": seen,
            }
            for outcome, prior, probability, seen in zip(
                outcomes_of(model, entry.rule), entry.priors, entry.probabilities, entry.seen, strict=True
            )
        ],
    }


def _rule_name(model: Domain, entry: Learned) -> str:
    return "default" if entry.rule is None else model.rules[entry.rule].name
