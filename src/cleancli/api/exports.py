"""A domain and its problems as files of other languages."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from cleancli.api.checks import check_one_of
from cleancli.api.conversion_result import ConversionResult
from cleancli.api.experience_files import (
    is_experience,
    objects_of,
    transitions_of,
    with_data,
    with_trajectories,
)
from cleancli.api.inputs import LoadedDomain, LoadedProblem, load_problem, opened_domain
from cleancli.compiler.horizon import first_horizon
from cleancli.conversion.export.libprada import libprada
from cleancli.conversion.export.libprada_names import LibpradaNames
from cleancli.conversion.export.ppddl import ppddl
from cleancli.conversion.export.rddl import rddl
from cleancli.conversion.export.unsaid import Unsaid
from cleancli.conversion.export.written import NOISE, Written
from cleancli.conversion.pddl.recognized import is_pddl
from cleancli.language.diagnostics.diagnostic import Diagnostic, Source, Span
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.find import find
from cleancli.language.load import kind_of, read_source
from cleancli.language.model import Problem
from cleancli.planning.plan import BadOption

_LANGUAGES = {"ppddl": "PPDDL", "libprada": "libPRADA", "rddl": "RDDL"}
"""What messages call them."""


def exported(files: Sequence[str], to: str, noise: str, include_outside: bool) -> ConversionResult:
    """The files of another language, `to`, that a domain and its problems become: names of shipped files,
    paths or texts, .nid or PPDDL. Raises Refused with everything that can't be said, and BadOption."""
    check_one_of("noise", noise, NOISE)
    experience = [name for name in files if is_experience(name)]
    if experience and to == "rddl":
        raise BadOption("RDDL has no files of experience")
    domain, problems = opened([name for name in files if name not in experience], include_outside)
    models = [each.model for each in problems if isinstance(each.model, Problem)]
    unsaid = Unsaid(_LANGUAGES[to], domain.sources)
    if to == "ppddl":
        made = ppddl(domain.model, models, noise, unsaid)
        return with_trajectories(_result(domain, problems, made), domain.model, experience)
    if len(models) != 1:
        raise BadOption("give one problem: only in PPDDL a domain stands for itself")
    (problem,) = models
    if to == "libprada":
        return _of_libprada(domain, problem, noise, unsaid, experience)
    made = rddl(domain.model, problem, first_horizon(domain.model, problem), noise, unsaid)
    return _result(domain, problems, made)


def _of_libprada(
    domain: LoadedDomain, problem: Problem, noise: str, unsaid: Unsaid, experience: Sequence[str]
) -> ConversionResult:
    """The rules stand for the domain, and the state for the problem; experience goes beside them."""
    model = domain.model
    transitions = transitions_of(experience, model)
    names = LibpradaNames(model, problem, objects_of(transitions) if experience else None)
    made = libprada(model, problem, noise, unsaid, names)
    texts = {problem.name: made.texts["state.dat"]}
    rules = made.texts["rules.dat"]
    files = ConversionResult(domain.name, rules, texts, {}, made.notes, (), (), made.texts, made.names)
    return with_data(files, model, names, transitions) if experience else files


def _result(domain: LoadedDomain, problems: Sequence[LoadedProblem], made: Written) -> ConversionResult:
    first, *others = made.texts.values()
    texts = dict(zip((each.name for each in problems), others, strict=True))
    return ConversionResult(domain.name, first, texts, {}, made.notes, (), (), made.texts, made.names)


def opened(files: Sequence[str], include_outside: bool) -> tuple[LoadedDomain, list[LoadedProblem]]:
    """The one domain among the files, and all problems; raises Refused and BadOption."""
    sources = [_source(given, number) for number, given in enumerate(files, 1)]
    domains = [source for source in sources if _defines(source, "domain")]
    if len(domains) != 1:
        _refuse_unreadable(sources)
        found = "none of these is one" if not domains else f"{len(domains)} of these are one"
        raise BadOption(f"give one domain, and any number of its problems: {found}")
    (domain,) = domains
    loaded = opened_domain(domain, include_outside)
    rest = [source for source in sources if _defines(source, "problem")]
    problems = [load_problem(_given(source), _given(domain) if loaded.is_pddl else loaded) for source in rest]
    _refuse_scenes(problems)
    return (problems[0].domain if loaded.is_pddl and problems else loaded), problems


def _source(given: str, number: int) -> Source:
    """A text, or that of a shipped file or a path."""
    if "{" in given or is_pddl(Source("", given)):
        return Source(f"<text {number}>", given)
    return read_source(find(given, "domains", "problems"))


def _given(source: Source) -> str | Path:
    """What loads a source again."""
    return source.text if source.path.startswith("<text ") else Path(source.path)


def _defines(source: Source, kind: str) -> bool:
    """Whether a text defines a domain, or else a problem (a scene is one)."""
    if is_pddl(source):
        from cleancli.conversion.pddl.models import defines_domain, defines_problem

        return defines_domain(source) if kind == "domain" else defines_problem(source)
    return (kind_of(source) == "domain") == (kind == "domain")


def _refuse_unreadable(sources: Sequence[Source]) -> None:
    """Raises Refused for a text in PDDL with mistakes that may hide what it defines."""
    from cleancli.conversion.pddl.models import refuse_unreadable

    for source in filter(is_pddl, sources):
        refuse_unreadable(source)


def _refuse_scenes(problems: Sequence[LoadedProblem]) -> None:
    """Raises Refused for tables to look at: what holds there is not known before a camera has looked."""
    message, help = "a scene is no list of facts", "give a problem, `problem NAME { ... }`"
    scenes = [problem.source for problem in problems if problem.is_scene]
    if scenes:
        raise Refused([Diagnostic("E106", message, Span(s.path, 0, 0), help=help) for s in scenes], scenes)
