"""Experience beside the domains that are converted: its lines as files of other languages, and back."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from cleancli.api.conversion_result import ConversionResult
from cleancli.compiler.lifted_state import LiftedRules
from cleancli.conversion.convert import Converted
from cleancli.conversion.experience.chains import Chain, chains_of
from cleancli.conversion.experience.data import data_text, read_data, recorded
from cleancli.conversion.experience.trajectories import TrajectoryWriter, read_trajectories
from cleancli.conversion.export.libprada_names import LibpradaNames
from cleancli.conversion.export.names import Naming
from cleancli.language.diagnostics.diagnostic import Diagnostic, Source, Span
from cleancli.language.diagnostics.plural import plural
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.diagnostics.sink import Findings
from cleancli.language.load import read_source
from cleancli.language.model import Domain, Object, Problem
from cleancli.learning.experience import Transition, encode, read_experience
from cleancli.planning.plan import BadOption

LINES = ".jsonl"
"""What the names of experience end with."""

TRAJECTORY = ".trajectory"
"""What the names of trajectories end with."""

DATA = "data.dat"
"""What libPRADA's experience is called."""

EXPERIENCE = f"experience{LINES}"
"""What is written of files of other languages."""

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


def is_data(name: str) -> bool:
    """Whether a file is one of libPRADA, by its name."""
    return name.lower().endswith(".dat")


def with_trajectories(made: ConversionResult, domain: Domain, paths: Sequence[str]) -> ConversionResult:
    """What was written of a domain as PPDDL, with the trajectories that files of experience become. Raises
    Refused."""
    if not paths:
        return made
    naming = Naming([], folded=True)
    every = [
        _Several(naming.fresh(Path(path).stem), tuple(chains_of(transitions_of([path], domain))))
        for path in paths
    ]
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
    told = _uncovered([chain for each in every for chain in each.chains], domain)
    return replace(made, texts=texts, notes=(*made.notes, _LOST, *told), names=names)


def _uncovered(chains: Iterable[Chain], domain: Domain) -> Iterator[str]:
    """How many actions no rule covers: who learns preconditions from trajectories takes each as possible."""
    rules = LiftedRules(domain)
    count = sum(
        rules.covering(rules.state(each.objects, each.before), each.action, each.arguments) is None
        for chain in chains
        for each in chain.transitions()
    )
    if count:
        are = "was" if count == 1 else "were"
        yield (
            f"{plural(count, 'action')} in the trajectories {are} tried where no rule covers it, which PPDDL"
            " forbids: learners that take what was done as possible learn too weak preconditions from that"
        )


def transitions_of(paths: Sequence[str], domain: Domain) -> tuple[Transition, ...]:
    """The transitions of files of experience, in order. Raises Refused."""
    return tuple(each for path in paths for each in read_experience(path, domain))


def objects_of(transitions: Iterable[Transition]) -> list[Object]:
    """All objects of transitions, in order."""
    return sorted({thing for each in transitions for thing in each.objects})


def with_data(
    made: ConversionResult, domain: Domain, names: LibpradaNames, transitions: Sequence[Transition]
) -> ConversionResult:
    """What was written of a domain for libPRADA, with experience beside it."""
    chains = tuple(chains_of(transitions))
    shape = "states and actions in turn" if len(chains) == 1 else "each action between two states of its own"
    return replace(
        made,
        texts={**made.texts, DATA: data_text(chains, domain, names)},
        notes=(*made.notes, f"{DATA} has {shape}", _LOST),
    )


@dataclass(frozen=True, slots=True)
class Traces:
    """Files that become experience: trajectories of PDDL, and those of libPRADA."""

    trajectories: tuple[str, ...]
    data: tuple[str, ...]


def traces_in(files: Sequence[str]) -> Traces:
    """Those among some files; files of libPRADA alone are a domain."""
    data = tuple(name for name in files if is_data(name))
    traced = tuple(name for name in files if is_trajectory(name))
    return Traces(traced, data if len(data) + len(traced) < len(files) else ())


def with_experience(
    made: ConversionResult, traces: Traces, domain: Domain, problems: Sequence[Problem], *, whole: bool
) -> ConversionResult:
    """What was made of a domain, with the lines of experience that files become.

    Objects are those that a trajectory lists, or all problems have. With `whole` each predicate of a
    trajectory has to be one of the domain. Raises Refused, and BadOption.
    """
    sources = {path: read_source(path) for path in (*traces.trajectories, *traces.data)}
    objects = sorted({thing for problem in problems for thing in problem.objects})
    findings = Findings(Source("", ""))
    found: list[Transition] = []
    lacking: set[str] = set()
    for path in traces.trajectories:
        findings.include(sources[path], (), frozenset())
        read = read_trajectories(sources[path], domain, objects, findings, whole=whole)
        found += [each for chain in read.chains for each in chain.transitions()]
        lacking.update(read.passed_over)
    findings.refuse_errors()
    if traces.data:
        if len(problems) != 1:
            raise BadOption(f"give the problem too: it names the objects that are numbers in {DATA}")
        names = LibpradaNames(domain, problems[0], ())
        for path in traces.data:
            found += read_data(sources[path], domain, objects, names)
    notes = [f"left out: predicates that the domain lacks: {', '.join(sorted(lacking))}"] if lacking else []
    told = replace(
        made,
        diagnostics=(*made.diagnostics, *findings.sorted),
        sources=(*made.sources, *sources.values()),
    )
    return _with_lines(told, found, notes)


def with_recorded(made: ConversionResult, source: Source, converted: Converted) -> ConversionResult:
    """What libPRADA's files became, with its experience. Raises Refused."""
    found = recorded(source, converted)
    notes = [f"left out: what actions have done that the domain lacks: {', '.join(found.lacking)}"]
    return _with_lines(made, found.transitions, notes if found.lacking else [])


def _with_lines(
    made: ConversionResult, transitions: Iterable[Transition], notes: Sequence[str]
) -> ConversionResult:
    lines = "".join(f"{encode(each, {})}\n" for each in transitions)
    return replace(made, texts={**made.texts, EXPERIENCE: lines}, notes=(*made.notes, *notes))
