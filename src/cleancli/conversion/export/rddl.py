"""A .nid domain and one problem of it as RDDL (Sanner 2010), as pyRDDLGym reads it.

One action at a time. Each rule has a fluent that says where it applies, and one that draws its outcome, so
that what an outcome changes, changes together. Each state fluent is what the one outcome makes of it, or
stays. Objects have the types that stand above all others; narrower ones are non-fluents, as are
objects that the domain or the goal names.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from cleancli.conversion.export.changes import changes_of, hits
from cleancli.conversion.export.draws import draws_of
from cleancli.conversion.export.names import Naming
from cleancli.conversion.export.rddl_formulas import FormulaWriter
from cleancli.conversion.export.unsaid import Unsaid
from cleancli.conversion.export.written import Written, closure_of
from cleancli.conversion.pddl.effects import Change
from cleancli.conversion.pddl.formula import (
    ALWAYS,
    NEVER,
    Formula,
    apart,
    assuming,
    free_variables,
)
from cleancli.language.diagnostics.diagnostic import Span
from cleancli.language.model import (
    Action,
    Domain,
    Object,
    Outcome,
    OutcomeKind,
    Problem,
    RewardKind,
    RewardTerm,
    Rule,
    Symbol,
    Term,
    Unlimited,
    Value,
    Variable,
    weight_of,
)
from cleancli.language.printing.printer import print_float, print_fraction


@dataclass(frozen=True, slots=True)
class _Draw:
    """What is drawn by itself when a rule applies: what each result changes, and what it pays. The fluent and
    its type have names, and so has each result, where there are several."""

    chances: tuple[Fraction, ...]
    changes: tuple[tuple[Change, ...], ...]
    paid: tuple[Fraction, ...]
    fluent: str
    type: str
    results: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class _Ruled:
    """A rule, where it applies, and what is drawn of its outcomes that may happen."""

    rule: Rule
    name: str
    known: Formula
    draws: tuple[_Draw, ...]


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
        self._symbols = {symbol.name: symbol for symbol in domain.symbols}
        self.title, self.instance = (self._texts.name("file", each.name) for each in (domain, problem))
        self._rules = [ruled for rule in domain.rules for ruled in self._ruled(rule)]
        if isinstance(problem.horizon, Unlimited):
            unsaid.note(
                f"`horizon = unlimited` of `{problem.name}`: rewards are summed up to a horizon", None
            )

    def _ruled(self, rule: Rule) -> Iterator[_Ruled]:
        with self._unsaid.of(rule.span):
            known = self._formulas.applies(rule)
            likely = [outcome for outcome in rule.outcomes if outcome.probability]
            parts = [(outcome.probability, self._parts(outcome, rule, known)) for outcome in likely]
            self._refuse_closures(rule.span, "")
            name = self._texts.name("rule", f"{rule.name}_applies")
            yield _Ruled(rule, name, known, tuple(self._draws(rule, parts)))

    def _parts(self, outcome: Outcome, rule: Rule, known: Formula) -> list[Change | Fraction]:
        """What an outcome changes, and what it pays by itself."""
        price = outcome.reward + weight_of(self._domain, RewardKind.COST) * outcome.cost
        changes = changes_of(outcome, rule, known, self._formulas, self._noise)
        return [*changes, *([price] if price else [])]

    def _draws(
        self, rule: Rule, parts: Sequence[tuple[Fraction, list[Change | Fraction]]]
    ) -> Iterator[_Draw]:
        """The draws of a rule; they are numbered where several have several results."""
        found = draws_of(parts)
        several = [draw for draw in found if len(draw) > 1]
        for draw in found:
            title = rule.name if len(several) < 2 else f"{rule.name}_{found.index(draw) + 1}"
            own = f"{rule.name} {found.index(draw)}"  # what tells the names of one draw from those of others
            results = range(1, len(draw) + 1) if len(draw) > 1 else ()
            yield _Draw(
                tuple(chance for chance, _ in draw),
                tuple(tuple(each for each in result if isinstance(each, Change)) for _, result in draw),
                tuple(sum((e for e in result if isinstance(e, Fraction)), Fraction(0)) for _, result in draw),
                self._texts.name(f"drawn {own}", f"{title}_drawn") if results else "",
                self._texts.name(f"outcomes {own}", f"{title}_outcome") if results else "",
                tuple(f"@{self._texts.name(f'outcome {own}', f'{title}_{number}')}" for number in results),
            )

    def _refuse_closures(self, place: Span | None, of: str) -> None:
        """Tells of closures that what was said last speaks of, and that are no facts."""
        for name, closure in list(self._formulas.closures.items()):
            if not self._formulas.has_facts(closure):
                self._unsaid.note(f"{of}the closure `{name}` of more than a few objects", place)
                del self._formulas.closures[name]

    # ---- names

    def _some(self, variables: Sequence[Variable], texts: Sequence[str]) -> str:
        """That all texts hold for some objects."""
        said = " ^ ".join(text for text in texts if text != "true") or "true"
        return f"(exists_{{{self._texts.typed(variables)}}} [{said}])" if variables else f"({said})"

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
        reward = self._reward()
        blocks = [
            ("types", list(self._type_lines())),
            ("pvariables", list(self._declarations())),
            ("cpfs", cpfs),
        ]
        text = "".join(f"    {name} {{\n" + _indented(lines) + "    };\n\n" for name, lines in blocks)
        preconditions = f"    action-preconditions {{\n{_indented(conditions)}    }};\n" if conditions else ""
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

    def _rule_fluents(self, ruled: _Ruled) -> Iterator[str]:
        """Where the rule applies, and what its draws come to."""
        rule = ruled.rule
        action = f"{self._texts.name('action', rule.action)}{self._texts.arguments(rule.variables)}"
        known = self._texts.formula(self._formulas.apart(ruled.known, rule.variables))
        asked = [] if ruled.known == ALWAYS else [known]
        said = " ^ ".join([action, *self._texts.fits(rule.variables), *asked])
        yield f"{ruled.name}{self._texts.arguments(rule.variables)} = {said};"
        for draw in (draw for draw in ruled.draws if draw.results):
            pairs = zip(draw.results, draw.chances, strict=True)
            chances = ", ".join(f"{result}: {_number(chance)}" for result, chance in pairs)
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

    def _cases(self, ruled: _Ruled, symbol: Symbol, value: Value, terms: Sequence[Variable]) -> Iterator[str]:
        """When a rule gives the terms a value."""
        wanted = self._formulas.predicates.of(symbol.name, None if symbol.is_predicate else value)
        sets = not symbol.is_predicate or value is True
        for draw, place, changes in _results(ruled):
            for change in changes:
                if change.symbol == wanted and change.value is sets:
                    hit = assuming(hits(change, terms, self._formulas), [ruled.known])
                    if hit != NEVER:
                        hit = self._formulas.apart(hit, [*terms, *ruled.rule.variables])
                        yield self._case(ruled, draw, place, self._texts.formula(hit))

    def _case(self, ruled: _Ruled, draw: _Draw, place: int, hit: str) -> str:
        """That the rule applies, a draw has the result at a place, and something holds."""
        applies = f"{ruled.name}{self._texts.arguments(ruled.rule.variables)}"
        drawn = [f"({draw.fluent} == {draw.results[place]})"] if draw.results else []
        return self._some(ruled.rule.variables, [applies, *drawn, hit])

    def _next_noise(self, noise: str) -> str:
        cases = [
            self._case(ruled, draw, place, "true")
            for ruled in self._rules
            for draw, place, changes in _results(ruled)
            if any(change.symbol == noise for change in changes)
        ]
        return f"{noise}' = {' | '.join([noise, *cases])};"

    def _preconditions(self) -> Iterator[str]:
        """That an action is taken only where a rule covers it."""
        for action in self._domain.actions:
            covering = [ruled for ruled in self._rules if ruled.rule.action == action.name]
            if not all(ruled.known == ALWAYS for ruled in covering):
                yield self._precondition(action, covering)

    def _precondition(self, action: Action, covering: Sequence[_Ruled]) -> str:
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

    # ---- what is paid

    def _reward(self) -> str:
        found = [text for term in self._domain.reward for text in self._paid(term)]
        found += [text for ruled in self._rules for text in self._by_outcomes(ruled)]
        return "\n        + ".join(found) or "0"

    def _paid(self, term: RewardTerm) -> Iterator[str]:
        """A term of the reward; parts that no outcome changes are left out of what a count has fallen."""
        weight = _number(term.weight)
        match term.kind:
            case RewardKind.DECREASE | RewardKind.COUNT:
                (count,) = (each for each in self._domain.counts if each.name == term.count)
                with self._unsaid.of(None, f"the count `{count.name}`"):
                    formula = self._formulas.apart(self._formulas.condition(count.condition), count.variables)
                    self._refuse_closures(None, f"the count `{count.name}`: ")
                    after = self._counted(count.variables, formula, after=True)
                    if term.kind is RewardKind.COUNT:
                        yield f"({weight}) * {after}"
                    else:
                        before = self._counted(count.variables, formula, after=False)
                        yield f"({weight}) * ({before} - {after})"
            case RewardKind.GOAL if self._problem.goal:
                with self._unsaid.of(None, f"the goal of `{self._problem.name}`"):
                    goal = self._formulas.condition(self._problem.goal)
                    self._refuse_closures(None, f"the goal of `{self._problem.name}`: ")
                    before, after = self._texts.formula(goal), self._texts.formula(goal, after=True)
                    holds = "if ({}) then 1.0 else 0.0"
                    yield f"({weight}) * (({holds.format(after)}) - ({holds.format(before)}))"
            case RewardKind.GOAL:
                pass
            case RewardKind.COST | RewardKind.DURATION:
                for action in self._domain.actions:
                    price = action.cost if term.kind is RewardKind.COST else Fraction(action.duration or 0)
                    if price:
                        yield f"({_number(term.weight * price)}) * {self._done(action)}"
                    if term.kind is RewardKind.COST:
                        yield from self._by_functions(action, term.weight)

    def _by_outcomes(self, ruled: _Ruled) -> Iterator[str]:
        """What the outcomes of a rule pay by themselves."""
        for draw, place, _ in _results(ruled):
            if price := draw.paid[place]:
                happens = self._case(ruled, draw, place, "true")
                yield f"({_number(price)}) * (if ({happens}) then 1.0 else 0.0)"

    def _by_functions(self, action: Action, weight: Fraction) -> Iterator[str]:
        """What the action is paid by values of functions for its objects, so many times what it costs."""
        called = f"{self._texts.name('action', action.name)}{self._texts.arguments(action.parameters)}"
        for part in action.cost_parts:
            if amount := weight * part.weight:
                variables, constants = self._texts.for_constants(part.terms, action.parameters)
                named = self._texts.chosen(constants)
                value = f"{self._texts.fluent(part.symbol)}{self._texts.arguments(variables)}"
                done = " ^ ".join([called, *self._texts.fits(action.parameters), *named])
                bound = self._texts.typed([*action.parameters, *constants])
                summed = f"({done}) * {value}"
                yield f"({_number(amount)}) * " + (f"(sum_{{{bound}}} [{summed}])" if bound else summed)

    def _counted(self, variables: Sequence[Variable], formula: Formula, *, after: bool) -> str:
        said = " ^ ".join([*self._texts.fits(variables), self._texts.formula(formula, after=after)])
        if not variables:
            return f"(if ({said}) then 1.0 else 0.0)"
        return f"(sum_{{{self._texts.typed(variables)}}} [{said}])"

    def _done(self, action: Action) -> str:
        """1 where the action is done."""
        return self._counted(action.parameters, ALWAYS, after=False).replace(
            "true", f"{self._texts.name('action', action.name)}{self._texts.arguments(action.parameters)}"
        )

    # ---- the instance

    def instance_text(self, horizon: int) -> str:
        """The text of the instance."""
        problem = self._problem
        things = (*self._domain.constants, *problem.objects)
        objects = []
        for root in (each.name for each in self._domain.types if each.parent is None):
            names = ", ".join(
                self._texts.name("object", o.name) for o in things if self._texts.root(o.type) == root
            )
            if not names:
                self._unsaid.note(f"`{problem.name}` has no object of the type `{root}`", None)
            objects.append(f"{self._texts.type_of(root)}: {{{names}}};")
        fixed, begun = list(self._fixed(things)), list(self._facts(moving=True))
        facts = f"{self.instance}_facts"
        discount = print_float(problem.discount)
        return (
            f"// Written by `cleancli convert` from a .nid file.\nnon-fluents {facts} {{\n"
            f"    domain = {self.title};\n"
            + (f"    objects {{\n{_indented(objects)}    }};\n" if objects else "")
            + (f"    non-fluents {{\n{_indented(fixed)}    }};\n" if fixed else "")
            + f"}}\n\ninstance {self.instance} {{\n    domain = {self.title};\n    non-fluents = {facts};\n"
            + (f"    init-state {{\n{_indented(begun)}    }};\n" if begun else "")
            + f"    max-nondef-actions = 1;\n    horizon = {horizon};\n"
            f"    discount = {discount if '.' in discount else f'{discount}.0'};\n}}\n"
        )

    def _fixed(self, things: Sequence[Object]) -> Iterator[str]:
        for kind in (each.name for each in self._domain.types if each.parent is not None):
            for thing in things:
                if self._domain.is_a(thing.type, kind):
                    yield f"{self._texts.mark('type', kind)}({self._texts.name('object', thing.name)});"
        for name in self._texts.singled:
            yield f"{self._texts.mark('constant', name)}({self._texts.name('object', name)});"
        yield from self._facts(moving=False)
        for closure in self._formulas.closures.values():
            base = self._symbols[closure.closure or ""]
            for pair in sorted(closure_of(self._problem.state, base.name, base.symmetric)):
                arguments = ", ".join(self._texts.name("object", name) for name in pair)
                yield f"{self._texts.fluent(closure.name)}({arguments});"

    def _facts(self, *, moving: bool) -> Iterator[str]:
        """The facts about what can change, or about what never does; symmetric ones both ways round."""
        for fact in sorted(self._problem.state, key=lambda f: (f.symbol, f.objects)):
            symbol = self._symbols[fact.symbol]
            if (symbol.name in self._formulas.changed) is not moving:
                continue
            ways = {fact.objects, fact.objects[::-1]} if symbol.symmetric else {fact.objects}
            for names in sorted(ways):
                arguments = (
                    f"({', '.join(self._texts.name('object', name) for name in names)})" if names else ""
                )
                value = "" if symbol.is_predicate else f" = {self._texts.value_of(symbol, fact.value)}"
                yield f"{self._texts.fluent(symbol.name)}{arguments}{value};"

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


def _variables_of(ruled: _Ruled) -> Iterator[Term]:
    """All variables that have to do with a rule."""
    yield from ruled.rule.variables
    for _, _, changes in _results(ruled):
        for change in changes:
            yield from (*change.variables, *change.terms, *free_variables(change.guard))


def _results(ruled: _Ruled) -> Iterator[tuple[_Draw, int, tuple[Change, ...]]]:
    """All results of the draws of a rule, each with its draw and its place there."""
    for draw in ruled.draws:
        for place, changes in enumerate(draw.changes):
            yield draw, place, changes


def _indented(lines: Sequence[str]) -> str:
    return "".join(f"        {part}\n" for line in lines for part in line.split("\n"))


def _number(value: Fraction) -> str:
    """A number as RDDL writes it."""
    text = print_fraction(abs(value))
    decimal = f"{value.numerator}.0 / {value.denominator}.0".lstrip("-") if "/" in text else text
    return f"-{decimal}" if value < 0 else decimal
