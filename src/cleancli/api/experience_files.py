"""Experience beside the domains that are converted: its lines as files of other languages, and back."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from cleancli.api.conversion_result import ConversionResult
from cleancli.conversion.experience.chains import Chain, chains_of
from cleancli.conversion.experience.trajectories import TrajectoryWriter, read_trajectories
from cleancli.conversion.export.names import Naming
from cleancli.language.diagnostics.diagnostic import Diagnostic, Source, Span
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.diagnostics.sink import Findings
from cleancli.language.load import read_source
from cleancli.language.model import Domain, Problem
from cleancli.learning.experience import encode, read_experience

LINES = ".jsonl"
"""What the names of experience end with."""

TRAJECTORY = ".trajectory"
"""What the names of trajectories end with."""

EXPERIENCE = f"experience{LINES}"
"""What is written of trajectories."""

MOST = 10_000
"""Trajectories that one conversion writes, a file each. Chosen."""

_LOST = "left out of the experience: how long actions took, and what its lines say beside the transitions"


@dataclass(frozen=True, slots=True)
class _Several:
    """The chains of one file of experience, and what the files are called that they become."""

    name: str
    chains: tuple[Chain, ...]


def is_experience(name: str) -> bool:
    """Whether a file is experience, by its name."""
    return name.lower().endswith(LINES)


def is_trajectory(name: str) -> bool:
    """Whether a file is a trajectory of PDDL, by its name."""
    return name.lower().endswith(TRAJECTORY)


def with_trajectories(made: ConversionResult, domain: Domain, paths: Sequence[str]) -> ConversionResult:
    """What was written of a domain as PPDDL, with the trajectories that files of experience become. Raises
    Refused."""
    if not paths:
        return made
    naming = Naming([], folded=True)
    every = [_Several(naming.fresh(Path(path).stem), _chains(path, domain)) for path in paths]
    if (count := sum(len(each.chains) for each in every)) > MOST:
        message = f"the experience comes to {count} trajectories, and {MOST} are written at most"
        place = Span(paths[0], 0, 0)
        found = Diagnostic("E919", message, place, help="divide the files")
        raise Refused([found], [Source(paths[0], "")])
    writer = TrajectoryWriter(domain)
    texts = dict(made.texts)
    for each in every:
        digits = len(str(len(each.chains)))
        for number, chain in enumerate(each.chains, 1):
            title = each.name if len(each.chains) == 1 else f"{each.name}-{number:0{digits}}"
            texts[f"{title}{TRAJECTORY}"] = writer.text(chain)
    names = {**made.names, **writer.changed_names}
    return replace(made, texts=texts, notes=(*made.notes, _LOST), names=names)


def _chains(path: str, domain: Domain) -> tuple[Chain, ...]:
    return tuple(chains_of(read_experience(path, domain)))


def with_experience(
    made: ConversionResult, paths: Sequence[str], domain: Domain, problems: Iterable[Problem], *, whole: bool
) -> ConversionResult:
    """What was made of a domain, with the lines of experience that trajectories are.

    Objects are those that a trajectory lists, or all problems have. With `whole` each predicate has to be one
    of the domain. Raises Refused.
    """
    objects = sorted({thing for problem in problems for thing in problem.objects})
    sources = [read_source(path) for path in paths]
    findings = Findings(sources[0])
    lines: list[str] = []
    lacking: set[str] = set()
    for source in sources:
        if source is not sources[0]:
            findings.include(source, (), frozenset())
        found = read_trajectories(source, domain, objects, findings, whole=whole)
        lines += [encode(each, {}) for chain in found.chains for each in chain.transitions()]
        lacking.update(found.passed_over)
    findings.refuse_errors()
    notes = [f"left out: predicates that the domain lacks: {', '.join(sorted(lacking))}"] if lacking else []
    return replace(
        made,
        texts={**made.texts, EXPERIENCE: "".join(f"{line}\n" for line in lines)},
        notes=(*made.notes, *notes),
        diagnostics=(*made.diagnostics, *findings.sorted),
        sources=(*made.sources, *sources),
    )
