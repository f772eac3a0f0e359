"""A .nid domain and one problem of it as RDDL (Sanner 2010), as pyRDDLGym reads it.

One action at a time. Each rule has a fluent that says where it applies, and one that draws its outcome, so
that what an outcome changes, changes together. Each state fluent is what the one outcome makes of it, or
stays. Objects have the types that stand above all others; narrower ones are non-fluents, as are
objects that the domain or the goal names.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from cleancli.conversion.export.changes import hits
from cleancli.conversion.export.names import Naming
from cleancli.conversion.export.rddl_formulas import FormulaWriter, indented, number
from cleancli.conversion.export.rddl_instance import InstanceWriter
from cleancli.conversion.export.rddl_rewards import RewardWriter
from cleancli.conversion.export.rddl_rules import Ruled, happens, results_of, ruled_by
from cleancli.conversion.export.unsaid import Unsaid
from cleancli.conversion.export.written import Written
from cleancli.conversion.pddl.formula import ALWAYS, NEVER, apart, assuming, free_variables
from cleancli.language.model import (
    Action,
    Domain,
    OutcomeKind,
    Problem,
    Symbol,
    Term,
    Unlimited,
    Value,
    Variable,
)


def rddl(domain: Domain, problem: Problem, horizon: int, noise: str, unsaid: Unsaid) -> Written:
    """The files of the domain and of the instance, for so many steps; `noise` is one of `NOISE`.

    What can't be said is told to `unsaid`, and then Refused raised with all of it (E919).
    """
    writer = _Writer(domain, problem, noise, unsaid)
    texts = writer.domain_text(), writer.instance_text(horizon)
    unsaid.refuse()
    files = Naming([], folded=True)
    names = [f"{files.fresh(name)}.rddl" for name in (writer.title, writer.instance)]
    return Written(dict(zip(names, texts, strict=True)), writer.notes(), writer.changed_names())


class _Writer:
    """Writes a domain and a problem, with the same names in both files."""

    def __init__(self, domain: Domain, problem: Problem, noise: str, unsaid: Unsaid) -> None:
        self._domain, self._problem, self._unsaid = domain, problem, unsaid
        self._noise = "noise" if noise == "predicate" else None
        self._texts = FormulaWriter(domain, problem, self._noise)
        self._formulas = self._texts.formulas
        self.title, self.instance = (self._texts.name("file", each.name) for each in (domain, problem))
        self._rules = ruled_by(domain, self._texts, unsaid)
        if isinstance(problem.horizon, Unlimited):
            unsaid.note(
                f"`horizon = unlimited` of `{problem.name}`: rewards are summed up to a horizon", None
            )

    # ---- the domain

    def domain_text(self) -> str:
        """The text of the domain."""
        cpfs = [line for ruled in self._rules for line in self._rule_fluents(ruled)]
        with self._unsaid.of(None):
            cpfs += [line for symbol in self._moving() for line in self._next(symbol)]
        if self._noise is not None:
            cpfs.append(self._next_noise(self._noise))
        # A name is declared once something speaks of it.
        conditions = list(self._preconditions())
        reward = RewardWriter(self._domain, self._problem, self._rules, self._texts, self._unsaid).text()
        blocks = [
            ("types", list(self._type_lines())),
            ("pvariables", list(self._declarations())),
            ("cpfs", cpfs),
        ]
        text = "".join(f"    {name} {{\n" + indented(lines) + "    };\n\n" for name, lines in blocks)
        preconditions = f"    action-preconditions {{\n{indented(conditions)}    }};\n" if conditions else ""
        head = "".join(
            f"// {line}\n" for line in ("Written by `cleancli convert` from a .nid file.", *self.notes())
        )
        return f"{head}domain {self.title} {{\n\n{text}    reward = {reward};\n\n{preconditions}}}\n"

    def _moving(self) -> list[Symbol]:
        return [symbol for symbol in self._domain.symbols if symbol.name in self._formulas.changed]

    def _type_lines(self) -> Iterator[str]:
        for root in (each.name for each in self._domain.types if each.parent is None):
            yield f"{self._texts.type_of(root)}: object;"
        for symbol in self._domain.symbols:
            if isinstance(symbol.values[0], str):
                values = ", ".join(self._texts.value_of(symbol, value) for value in symbol.values)
                yield f"{self._texts.range_of(symbol)}: {{{values}}};"
        for draw in (draw for ruled in self._rules for draw in ruled.draws if draw.results):
            yield f"{draw.type}: {{{', '.join(draw.results)}}};"

    def _declarations(self) -> Iterator[str]:
        fixed = "{non-fluent, bool, default = false}"
        for narrow in (each.name for each in self._domain.types if each.parent is not None):
            yield f"{self._texts.mark('type', narrow)}({self._texts.type_of(narrow)}): {fixed};"
        for name, kind in self._texts.singled.items():
            yield f"{self._texts.mark('constant', name)}({self._texts.type_of(kind)}): {fixed};"
        for closure in self._formulas.closures.values():
            yield f"{self._texts.fluent(closure.name)}{self._heads(closure.parameters)}: {fixed};"
        for symbol in self._domain.symbols:
            kind = "state-fluent" if symbol.name in self._formulas.changed else "non-fluent"
            default = self._texts.value_of(symbol, symbol.values[0])
            head = f"{self._texts.fluent(symbol.name)}{self._heads(symbol.parameters)}"
            yield f"{head}: {{{kind}, {self._texts.range_of(symbol)}, default = {default}}};"
        if self._noise is not None:
            yield f"{self._noise}: {{state-fluent, bool, default = false}};"
        for ruled in self._rules:
            yield f"{ruled.name}{self._heads(ruled.rule.variables)}: {{interm-fluent, bool}};"
            for draw in (draw for draw in ruled.draws if draw.results):
                yield f"{draw.fluent}: {{interm-fluent, {draw.type}}};"
        for action in self._domain.actions:
            name = self._texts.name("action", action.name)
            yield f"{name}{self._heads(action.parameters)}: {{action-fluent, bool, default = false}};"

    def _heads(self, variables: Sequence[Variable]) -> str:
        return f"({', '.join(self._texts.type_of(each.type) for each in variables)})" if variables else ""

    # ---- what happens

    def _rule_fluents(self, ruled: Ruled) -> Iterator[str]:
        """Where the rule applies, and what its draws come to."""
        rule = ruled.rule
        action = f"{self._texts.name('action', rule.action)}{self._texts.arguments(rule.variables)}"
        known = self._texts.formula(self._formulas.apart(ruled.known, rule.variables))
        asked = [] if ruled.known == ALWAYS else [known]
        said = " ^ ".join([action, *self._texts.fits(rule.variables), *asked])
        yield f"{ruled.name}{self._texts.arguments(rule.variables)} = {said};"
        for draw in (draw for draw in ruled.draws if draw.results):
            pairs = zip(draw.results, draw.chances, strict=True)
            chances = ", ".join(f"{result}: {number(chance)}" for result, chance in pairs)
            yield f"{draw.fluent} = Discrete({draw.type}, {chances});"

    def _next(self, symbol: Symbol) -> Iterator[str]:
        """What a symbol becomes: what is set first, then what is deleted."""
        met: list[Term] = [v for ruled in self._rules for v in _variables_of(ruled)]
        terms: list[Variable] = []
        for parameter in symbol.parameters:
            terms.append(apart(Variable(f"{parameter.name}_", parameter.type), [*met, *terms]))
        head = self._texts.arguments(terms)
        name = self._texts.fluent(symbol.name)
        chosen: list[tuple[str, str]] = []
        values: Sequence[Value] = (True, False) if symbol.is_predicate else symbol.values
        for value in values:
            cases = [case for ruled in self._rules for case in self._cases(ruled, symbol, value, terms)]
            if cases:
                chosen.append((" |\n        ".join(cases), self._texts.value_of(symbol, value)))
        text = f"{name}{head}"
        for condition, said in reversed(chosen):
            text = f"if ({condition})\n    then {said} else\n    {text}"
        yield f"{name}'{head} =\n    {text};"

    def _cases(self, ruled: Ruled, symbol: Symbol, value: Value, terms: Sequence[Variable]) -> Iterator[str]:
        """When a rule gives the terms a value."""
        wanted = self._formulas.predicates.of(symbol.name, None if symbol.is_predicate else value)
        sets = not symbol.is_predicate or value is True
        for draw, place, changes in results_of(ruled):
            for change in changes:
                if change.symbol == wanted and change.value is sets:
                    hit = assuming(hits(change, terms, self._formulas), [ruled.known])
                    if hit != NEVER:
                        hit = self._formulas.apart(hit, [*terms, *ruled.rule.variables])
                        yield happens(ruled, draw, place, self._texts.formula(hit), self._texts)

    def _next_noise(self, noise: str) -> str:
        cases = [
            happens(ruled, draw, place, "true", self._texts)
            for ruled in self._rules
            for draw, place, changes in results_of(ruled)
            if any(change.symbol == noise for change in changes)
        ]
        return f"{noise}' = {' | '.join([noise, *cases])};"

    def _preconditions(self) -> Iterator[str]:
        """That an action is taken only where a rule covers it."""
        for action in self._domain.actions:
            covering = [ruled for ruled in self._rules if ruled.rule.action == action.name]
            if not all(ruled.known == ALWAYS for ruled in covering):
                yield self._precondition(action, covering)

    def _precondition(self, action: Action, covering: Sequence[Ruled]) -> str:
        called = f"{self._texts.name('action', action.name)}{self._texts.arguments(action.parameters)}"
        texts = []
        for ruled in covering:
            names: dict[Term, Term] = dict(zip(ruled.rule.variables, action.parameters, strict=True))
            texts.append(self._texts.formula(self._formulas.renamed(ruled.known, names)))
        some = " |\n    ".join(texts)
        said = f"{called} =>\n    {' ^ '.join([*self._texts.fits(action.parameters), f'({some})'])}"
        return (
            f"forall_{{{self._texts.typed(action.parameters)}}} [{said}];"
            if action.parameters
            else f"{said};"
        )

    def instance_text(self, horizon: int) -> str:
        """The text of the instance, after that of the domain."""
        return InstanceWriter(self._domain, self._problem, self._texts, self._unsaid).text(horizon)

    # ---- what has to be told

    def notes(self) -> tuple[str, ...]:
        """What the files do not say as the .nid files do."""
        found = []
        every = (outcome for rule in self._domain.rules for outcome in rule.outcomes)
        outcomes = [outcome for outcome in every if outcome.probability]
        if any(outcome.kind is OutcomeKind.NOISE for outcome in outcomes):
            found.append(f"noise {'changes nothing' if self._noise is None else 'makes `noise` true'}")
        if self._formulas.written_out:
            found.append("closures are written out for as many objects as the problem has")
        if any(outcome.seen is not None for outcome in outcomes):
            found.append("what was learned, and how surely, is left out")
        return tuple(found)

    def changed_names(self) -> Mapping[str, str]:
        """The names that could not stay, with what they have become."""
        kinds = ("type", "symbol", "action", "object", "file")
        return {old: new for (kind, old), new in self._texts.given.items() if kind in kinds and old != new}


def _variables_of(ruled: Ruled) -> Iterator[Term]:
    """All variables that have to do with a rule."""
    yield from ruled.rule.variables
    for _, _, changes in results_of(ruled):
        for change in changes:
            yield from (*change.variables, *change.terms, *free_variables(change.guard))
