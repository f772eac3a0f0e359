"""What callers hand in for a domain and a problem: the name of a shipped file, a path, a text, or what was
loaded before."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from cleancli.api.tables import preformatted
from cleancli.conversion.pddl.recognized import is_pddl
from cleancli.language.diagnostics.diagnostic import Diagnostic, Source, Span
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.find import find
from cleancli.language.load import checked_domain, kind_of, read_source
from cleancli.language.load import load_problem as checked_problem
from cleancli.language.model import Domain, Problem

if TYPE_CHECKING:
    from cleancli.scene.model import Scene


@dataclass(frozen=True, slots=True)
class LoadedDomain:
    """A domain that holds no mistake; `sources` are its text and those that it includes. Prints as its
    text. One that was written in PPDDL cannot be changed in place: `is_pddl`."""

    name: str
    model: Domain
    sources: tuple[Source, ...]
    is_pddl: bool = False

    def __str__(self) -> str:
        return self.sources[0].text

    def __repr__(self) -> str:
        return f"<domain {self.name} of {self.sources[0].path}>"

    def _repr_html_(self) -> str:
        return preformatted(str(self))


@dataclass(frozen=True, slots=True)
class LoadedProblem:
    """A problem of a domain, or a scene, that holds no mistake. Prints as its text."""

    name: str
    model: Problem | Scene
    domain: LoadedDomain
    source: Source

    @property
    def is_scene(self) -> bool:
        """Whether it is a table to look at, and not a list of facts."""
        return not isinstance(self.model, Problem)

    @property
    def sources(self) -> tuple[Source, ...]:
        """All texts that went in, those of the domain first."""
        return (*self.domain.sources, self.source)

    def __str__(self) -> str:
        return self.source.text

    def __repr__(self) -> str:
        return f"<{'scene' if self.is_scene else 'problem'} {self.name} of {self.source.path}>"

    def _repr_html_(self) -> str:
        return preformatted(str(self))


GivenDomain = str | Path | LoadedDomain
"""The name of a shipped domain, a path, a text, or one that is loaded."""

GivenProblem = str | Path | LoadedProblem
"""The name of a shipped problem or scene, a path, a text, or one that is loaded."""


def load_domain(domain: GivenDomain, *, include_outside: bool = False) -> LoadedDomain:
    """Read and check a domain; `include_outside` lets it include files from outside its folder.

    A text is told from a name by its braces, or by the parenthesis that PPDDL begins with. Raises Refused
    with every mistake.
    """
    if isinstance(domain, LoadedDomain):
        return domain
    return opened_domain(source_of(domain, "domain"), include_outside)


def opened_domain(source: Source, include_outside: bool, *, compat: bool = False) -> LoadedDomain:
    """The domain of a text; `compat`: for planning as libPRADA does. Raises Refused."""
    if is_pddl(source):
        from cleancli.conversion.pddl.models import models_of  # few need it, and it takes time to load

        made = models_of(source)
        return LoadedDomain(made.domain.name, made.domain, made.sources, is_pddl=True)
    checked = checked_domain(source, include_outside, compat=compat)
    model = checked.get()
    return LoadedDomain(model.name, model, checked.sources)


def load_problem(problem: GivenProblem, domain: GivenDomain) -> LoadedProblem:
    """Read and check a problem of the domain, or a scene. Raises Refused with every mistake.

    What scenes are made of takes time to load, and most files are none. A problem in PPDDL is read together
    with its domain, which may name the problem's objects then.
    """
    if not isinstance(problem, LoadedProblem) and is_pddl(source := source_of(problem, "problem")):
        return _pddl_problem(source, domain)
    domain = _loaded_first(domain, problem)
    if isinstance(problem, LoadedProblem):
        if problem.domain.model == domain.model:
            return problem
        problem_source = problem.source
    else:
        problem_source = source_of(problem, "problem")
    if kind_of(problem_source) == "scene":
        from cleancli.scene.check import load_scene

        scene = load_scene(problem_source)
        return LoadedProblem(scene.name, scene, domain, problem_source)
    model = checked_problem(problem_source, domain.model)
    return LoadedProblem(model.name, model, domain, problem_source)


def _loaded_first(domain: GivenDomain, problem: GivenProblem) -> LoadedDomain:
    """The domain. Raises Refused, which says so where a problem was given first and its domain after it."""
    try:
        return load_domain(domain)
    except Refused as refused:
        (first, *_) = refused.diagnostics
        if first.code != "E106" or isinstance(problem, LoadedProblem):
            raise
        if kind_of(source_of(problem, "problem")) != "domain":
            raise
        raise Refused([replace(first, help="name the domain first")], refused.sources) from None


def refuse_learning_pddl(domain: LoadedDomain) -> None:
    """Raises Refused for a domain in PPDDL: learning changes numbers in a .nid text, and notes counts
    there."""
    if domain.is_pddl:
        source = domain.sources[0]
        message, help = "what is learned has no place in a PPDDL file", "convert it first: `cleancli convert`"
        raise Refused([Diagnostic("E106", message, Span(source.path, 0, 0), help=help)], [source])


def _pddl_problem(source: Source, domain: GivenDomain) -> LoadedProblem:
    """A problem that is written in PPDDL, as its domain is."""
    text = domain.sources[0] if isinstance(domain, LoadedDomain) else source_of(domain, "domain")
    if not is_pddl(text):
        message = "this problem is written in PPDDL, and its domain is not"
        help = "give the domain's PPDDL file, or convert both: `cleancli convert`"
        raise Refused([Diagnostic("E106", message, Span(source.path, 0, 0), help=help)], [source])
    from cleancli.conversion.pddl.models import models_of

    made = models_of(text, source)
    if len(made.problems) > 1:
        message, help = "this file defines several problems", "give a file of each"
        raise Refused([Diagnostic("E105", message, Span(source.path, 0, 0), help=help)], [source])
    (model,) = made.problems
    loaded = LoadedDomain(made.domain.name, made.domain, (text,), is_pddl=True)
    return LoadedProblem(model.name, model, loaded, source)


def source_of(given: str | Path, kind: str) -> Source:
    """The text that is meant: this one, that of a file, or that of a shipped domain or problem. Raises
    Refused (E001) where there is none."""
    if isinstance(given, str) and ("{" in given or is_pddl(Source("", given))):
        return Source(f"<{kind}>", given)
    return read_source(find(str(given), f"{kind}s"))
