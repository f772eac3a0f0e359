"""A .nid domain and one problem of it as RDDL (Sanner 2010), as pyRDDLGym reads it.

One action at a time. Each rule has a fluent that says where it applies, and one that draws its outcome, so
that what an outcome changes, changes together. Each state fluent is what the one outcome makes of it, or
stays. Objects have the types that stand above all others; narrower ones are non-fluents, as are
objects that the domain or the goal names.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from cleancli.conversion.export.changes import changes_of, hits
from cleancli.conversion.export.formulas import Formulas
from cleancli.conversion.export.names import Naming, Predicates
from cleancli.conversion.export.unsaid import Unsaid
from cleancli.conversion.export.written import Written, closure_of, counted
from cleancli.conversion.pddl.effects import Change
from cleancli.conversion.pddl.formula import (
    ALWAYS,
    NEVER,
    Both,
    Either,
    Formula,
    Quantified,
    apart,
    assuming,
    free_variables,
    negated,
)
from cleancli.language.diagnostics.diagnostic import Span
from cleancli.language.model import (
    Action,
    Domain,
    Equality,
    Literal,
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
)
from cleancli.language.printing.printer import print_float, print_fraction

_WORDS = frozenset(
    {
        "Bernoulli",
        "Beta",
        "DiracDelta",
        "Discrete",
        "KronDelta",
        "Normal",
        "Poisson",
        "Uniform",
        "abs",
        "action-fluent",
        "action-preconditions",
        "argmax",
        "argmin",
        "avg",
        "bool",
        "case",
        "cpfs",
        "default",
        "discount",
        "div",
        "domain",
        "else",
        "exists",
        "exp",
        "false",
        "forall",
        "horizon",
        "if",
        "init-state",
        "instance",
        "int",
        "interm-fluent",
        "inverse",
        "level",
        "ln",
        "log",
        "max",
        "min",
        "mod",
        "noise",
        "non-fluent",
        "non-fluents",
        "object",
        "objects",
        "observ-fluent",
        "otherwise",
        "pow",
        "prod",
        "pvariables",
        "real",
        "requirements",
        "reward",
        "round",
        "sgn",
        "sqrt",
        "state-fluent",
        "state-invariants",
        "sum",
        "switch",
        "termination",
        "then",
        "true",
        "types",
    }
)
"""Words of the language, and `noise`, which is none of .nid names."""


@dataclass(frozen=True, slots=True)
class _Ruled:
    """A rule, where it applies, and the changes of its outcomes that may happen."""

    rule: Rule
    name: str
    known: Formula
    outcomes: tuple[tuple[Outcome, tuple[Change, ...]], ...]


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
        self._naming = Naming(_WORDS, folded=False)
        self._given: dict[tuple[str, str], str] = {}
        self.title, self.instance = self._name("file", domain.name), self._name("file", problem.name)
        self._symbols = {symbol.name: symbol for symbol in domain.symbols}
        self._singled: dict[str, str] = {}  # the objects that something names, with their types
        # Formulas speak of predicates; `_said` tells which symbol, and which of its values, each stands for.
        naming = Naming((), folded=False)
        predicates = Predicates(naming, lambda symbol, value: f"{symbol}={value}")
        self._said: dict[str, tuple[str, Value]] = {}
        for symbol in domain.symbols:
            values: Sequence[Value | None] = [None] if symbol.is_predicate else symbol.values
            self._said |= {
                predicates.of(symbol.name, v): (symbol.name, True if v is None else v) for v in values
            }
        self._formulas = Formulas(domain, predicates, [counted(domain, problem)])
        self._rules = [ruled for rule in domain.rules for ruled in self._ruled(rule)]
        if isinstance(problem.horizon, Unlimited):
            unsaid.note(
                f"`horizon = unlimited` of `{problem.name}`: rewards are summed up to a horizon", None
            )

    def _ruled(self, rule: Rule) -> Iterator[_Ruled]:
        with self._unsaid.of(rule.span):
            known = self._formulas.applies(rule)
            likely = [outcome for outcome in rule.outcomes if outcome.probability]
            done = [(o, changes_of(o, rule, known, self._formulas, self._noise)) for o in likely]
            self._refuse_closures(rule.span, "")
            yield _Ruled(rule, self._name("rule", f"{rule.name}_applies"), known, tuple(done))

    def _refuse_closures(self, place: Span | None, of: str) -> None:
        """Tells of closures that what was said last speaks of, and that are no facts."""
        for name, closure in list(self._formulas.closures.items()):
            if not self._formulas.has_facts(closure):
                self._unsaid.note(f"{of}the closure `{name}` of more than a few objects", place)
                del self._formulas.closures[name]

    # ---- names

    def _name(self, kind: str, name: str) -> str:
        """What something is called; names end in a letter or digit and have no two underscores in a row."""
        if (kind, name) not in self._given:
            self._given[kind, name] = self._naming.fresh(re.sub("_+", "_", name).strip("_") or "n")
        return self._given[kind, name]

    def _root(self, kind: str) -> str:
        """The type above all others that a type is below, or is."""
        parents = {each.name: each.parent for each in self._domain.types}
        while (parent := parents[kind]) is not None:
            kind = parent
        return kind

    def _type(self, kind: str) -> str:
        return self._name("type", self._root(kind))

    def _is(self, kind: str, name: str) -> str:
        """The non-fluent that is true of the objects of a narrower type, or of one constant."""
        return self._name(f"is {kind}", f"is_{name}")

    def _value(self, symbol: Symbol, value: Value) -> str:
        if isinstance(value, int):
            return str(value).lower()
        return f"@{self._name('value', f'{symbol.name}_{value}')}"

    def _range(self, symbol: Symbol) -> str:
        first = symbol.values[0]
        if isinstance(first, bool):
            return "bool"
        return "int" if isinstance(first, int) else self._name("range", f"{symbol.name}_value")

    def _outcome(self, ruled: _Ruled, number: int) -> str:
        return f"@{self._name('outcome', f'{ruled.rule.name}_{number}')}"

    def _variable(self, variable: Variable) -> str:
        return "?" + self._name("variable", variable.name)

    # ---- conditions

    def _formula(self, formula: Formula, *, after: bool = False) -> str:
        """The text of a formula, about the state after the step if so."""
        match formula:
            case Literal(symbol, terms, values):
                said = self._literal(symbol, terms, after=after)
                return said if True in values else f"~{said}"
            case Equality(left, right, equal):
                same = self._same(left, right)
                return same if equal else f"~{same}"
            case Both(parts):
                return self._joined(" ^ ", parts, "true", after=after)
            case Either(parts):
                return self._joined(" | ", parts, "false", after=after)
            case Quantified(False, _, Either()):
                return f"~{self._formula(negated(formula), after=after)}"
            case Quantified(exists, variables, part):
                inner = self._formula(part, after=after)
                fits = self._fits(variables)
                if not exists:
                    said = f"[{' ^ '.join(fits)}] => {inner}" if fits else inner
                    return f"(forall_{{{self._typed(variables)}}} [{said}])"
                return f"(exists_{{{self._typed(variables)}}} [{' ^ '.join([*fits, inner])}])"

    def _joined(self, sign: str, parts: Sequence[Formula], none: str, *, after: bool) -> str:
        texts = [self._formula(part, after=after) for part in parts]
        return texts[0] if len(texts) == 1 else f"({sign.join(texts)})" if texts else none

    def _literal(self, predicate: str, terms: Sequence[Term], *, after: bool) -> str:
        name, value = self._said.get(predicate, (predicate, True))
        variables, constants = self._for_constants(terms)
        prime = "'" if after and (name in self._formulas.changed or name == self._noise) else ""
        called = f"{self._fluent(name)}{prime}{self._arguments(variables)}"
        said = called if value is True else f"({called} == {self._value(self._symbols[name], value)})"
        if not constants:
            return said
        kinds = ", ".join(f"{self._variable(v)}: {self._type(v.type)}" for v in constants)
        chosen = " ^ ".join(f"{self._is('constant', c)}({self._variable(v)})" for v, c in constants.items())
        return f"(exists_{{{kinds}}} [{chosen} ^ {said}])"

    def _fluent(self, name: str) -> str:
        return self._noise if name == self._noise and self._noise is not None else self._name("symbol", name)

    def _for_constants(
        self, terms: Sequence[Term], scope: Sequence[Variable] = ()
    ) -> tuple[list[Variable], dict[Variable, str]]:
        """The terms, each constant replaced by a variable that `scope` has not, and the constants by these
        variables."""
        found: list[Variable] = []
        constants: dict[Variable, str] = {}
        for term in terms:
            if isinstance(term, Object):
                met = [*scope, *(other for other in terms if isinstance(other, Variable))]
                self._singled[term.name] = term.type
                variable = apart(Variable(f"the_{term.name}", term.type), met)
                constants[variable] = term.name
                found.append(variable)
            else:
                found.append(term)
        return found, constants

    def _same(self, left: Term, right: Term) -> str:
        if isinstance(left, Variable) and isinstance(right, Variable):
            return f"({self._variable(left)} == {self._variable(right)})"
        variable, constant = (left, right) if isinstance(left, Variable) else (right, left)
        assert isinstance(variable, Variable)
        self._singled[constant.name] = constant.type
        return f"{self._is('constant', constant.name)}({self._variable(variable)})"

    def _typed(self, variables: Sequence[Variable]) -> str:
        return ", ".join(f"{self._variable(each)}: {self._type(each.type)}" for each in variables)

    def _fits(self, variables: Sequence[Variable]) -> list[str]:
        """That variables stand for objects of their types, where these are narrower than those of RDDL."""
        narrow = [each for each in variables if self._root(each.type) != each.type]
        return [f"{self._is('type', each.type)}({self._variable(each)})" for each in narrow]

    def _arguments(self, variables: Sequence[Variable]) -> str:
        return f"({', '.join(map(self._variable, variables))})" if variables else ""

    def _some(self, variables: Sequence[Variable], texts: Sequence[str]) -> str:
        """That all texts hold for some objects."""
        said = " ^ ".join(text for text in texts if text != "true") or "true"
        return f"(exists_{{{self._typed(variables)}}} [{said}])" if variables else f"({said})"

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
            yield f"{self._type(root)}: object;"
        for symbol in self._domain.symbols:
            if isinstance(symbol.values[0], str):
                values = ", ".join(self._value(symbol, value) for value in symbol.values)
                yield f"{self._range(symbol)}: {{{values}}};"
        for ruled in self._rules:
            if len(ruled.outcomes) > 1:
                names = ", ".join(self._outcome(ruled, n + 1) for n in range(len(ruled.outcomes)))
                yield f"{self._name('outcomes', f'{ruled.rule.name}_outcome')}: {{{names}}};"

    def _declarations(self) -> Iterator[str]:
        fixed = "{non-fluent, bool, default = false}"
        for narrow in (each.name for each in self._domain.types if each.parent is not None):
            yield f"{self._is('type', narrow)}({self._type(narrow)}): {fixed};"
        for name, kind in self._singled.items():
            yield f"{self._is('constant', name)}({self._type(kind)}): {fixed};"
        for closure in self._formulas.closures.values():
            yield f"{self._fluent(closure.name)}{self._heads(closure.parameters)}: {fixed};"
        for symbol in self._domain.symbols:
            kind = "state-fluent" if symbol.name in self._formulas.changed else "non-fluent"
            default = self._value(symbol, symbol.values[0])
            head = f"{self._fluent(symbol.name)}{self._heads(symbol.parameters)}"
            yield f"{head}: {{{kind}, {self._range(symbol)}, default = {default}}};"
        if self._noise is not None:
            yield f"{self._noise}: {{state-fluent, bool, default = false}};"
        for ruled in self._rules:
            yield f"{ruled.name}{self._heads(ruled.rule.variables)}: {{interm-fluent, bool}};"
            if len(ruled.outcomes) > 1:
                kind = self._name("outcomes", f"{ruled.rule.name}_outcome")
                yield f"{self._name('drawn', f'{ruled.rule.name}_drawn')}: {{interm-fluent, {kind}}};"
        for action in self._domain.actions:
            name = self._name("action", action.name)
            yield f"{name}{self._heads(action.parameters)}: {{action-fluent, bool, default = false}};"

    def _heads(self, variables: Sequence[Variable]) -> str:
        return f"({', '.join(self._type(each.type) for each in variables)})" if variables else ""

    # ---- what happens

    def _rule_fluents(self, ruled: _Ruled) -> Iterator[str]:
        """Where the rule applies, and which outcome it has."""
        rule = ruled.rule
        action = f"{self._name('action', rule.action)}{self._arguments(rule.variables)}"
        known = self._formula(self._formulas.apart(ruled.known, rule.variables))
        said = " ^ ".join([action, *self._fits(rule.variables), *([known] if ruled.known != ALWAYS else [])])
        yield f"{ruled.name}{self._arguments(rule.variables)} = {said};"
        if len(ruled.outcomes) > 1:
            kind = self._name("outcomes", f"{rule.name}_outcome")
            drawn = [
                f"{self._outcome(ruled, number)}: {_number(outcome.probability)}"
                for number, (outcome, _) in enumerate(ruled.outcomes, 1)
            ]
            name = self._name("drawn", f"{rule.name}_drawn")
            yield f"{name} = Discrete({kind}, {', '.join(drawn)});"

    def _next(self, symbol: Symbol) -> Iterator[str]:
        """What a symbol becomes: what is set first, then what is deleted."""
        met: list[Term] = [v for ruled in self._rules for v in _variables_of(ruled)]
        terms: list[Variable] = []
        for parameter in symbol.parameters:
            terms.append(apart(Variable(f"{parameter.name}_", parameter.type), [*met, *terms]))
        head = self._arguments(terms)
        name = self._fluent(symbol.name)
        chosen: list[tuple[str, str]] = []
        values: Sequence[Value] = (True, False) if symbol.is_predicate else symbol.values
        for value in values:
            cases = [case for ruled in self._rules for case in self._cases(ruled, symbol, value, terms)]
            if cases:
                chosen.append((" |\n        ".join(cases), self._value(symbol, value)))
        text = f"{name}{head}"
        for condition, said in reversed(chosen):
            text = f"if ({condition})\n    then {said} else\n    {text}"
        yield f"{name}'{head} =\n    {text};"

    def _cases(self, ruled: _Ruled, symbol: Symbol, value: Value, terms: Sequence[Variable]) -> Iterator[str]:
        """When a rule gives the terms a value."""
        wanted = self._formulas.predicates.of(symbol.name, None if symbol.is_predicate else value)
        sets = not symbol.is_predicate or value is True
        for number, (_, changes) in enumerate(ruled.outcomes, 1):
            for change in changes:
                if change.symbol == wanted and change.value is sets:
                    hit = assuming(hits(change, terms, self._formulas), [ruled.known])
                    if hit != NEVER:
                        yield self._case(
                            ruled,
                            number,
                            self._formula(self._formulas.apart(hit, [*terms, *ruled.rule.variables])),
                        )

    def _case(self, ruled: _Ruled, number: int, hit: str) -> str:
        applies = f"{ruled.name}{self._arguments(ruled.rule.variables)}"
        texts = [applies]
        if len(ruled.outcomes) > 1:
            drawn = self._name("drawn", f"{ruled.rule.name}_drawn")
            texts.append(f"({drawn} == {self._outcome(ruled, number)})")
        return self._some(ruled.rule.variables, [*texts, hit])

    def _next_noise(self, noise: str) -> str:
        cases = [
            self._case(ruled, number, "true")
            for ruled in self._rules
            for number, (_, changes) in enumerate(ruled.outcomes, 1)
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
        called = f"{self._name('action', action.name)}{self._arguments(action.parameters)}"
        texts = []
        for ruled in covering:
            names: dict[Term, Term] = dict(zip(ruled.rule.variables, action.parameters, strict=True))
            texts.append(self._formula(self._formulas.renamed(ruled.known, names)))
        some = " |\n    ".join(texts)
        said = f"{called} =>\n    {' ^ '.join([*self._fits(action.parameters), f'({some})'])}"
        return f"forall_{{{self._typed(action.parameters)}}} [{said}];" if action.parameters else f"{said};"

    # ---- what is paid

    def _reward(self) -> str:
        found = [text for term in self._domain.reward for text in self._paid(term)]
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
                    before, after = self._formula(goal), self._formula(goal, after=True)
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

    def _by_functions(self, action: Action, weight: Fraction) -> Iterator[str]:
        """What the action is paid by values of functions for its objects, so many times what it costs."""
        called = f"{self._name('action', action.name)}{self._arguments(action.parameters)}"
        for part in action.cost_parts:
            if amount := weight * part.weight:
                variables, constants = self._for_constants(part.terms, action.parameters)
                named = [f"{self._is('constant', c)}({self._variable(v)})" for v, c in constants.items()]
                value = f"{self._fluent(part.symbol)}{self._arguments(variables)}"
                done = " ^ ".join([called, *self._fits(action.parameters), *named])
                bound = self._typed([*action.parameters, *constants])
                summed = f"({done}) * {value}"
                yield f"({_number(amount)}) * " + (f"(sum_{{{bound}}} [{summed}])" if bound else summed)

    def _counted(self, variables: Sequence[Variable], formula: Formula, *, after: bool) -> str:
        said = " ^ ".join([*self._fits(variables), self._formula(formula, after=after)])
        if not variables:
            return f"(if ({said}) then 1.0 else 0.0)"
        return f"(sum_{{{self._typed(variables)}}} [{said}])"

    def _done(self, action: Action) -> str:
        """1 where the action is done."""
        return self._counted(action.parameters, ALWAYS, after=False).replace(
            "true", f"{self._name('action', action.name)}{self._arguments(action.parameters)}"
        )

    # ---- the instance

    def instance_text(self, horizon: int) -> str:
        """The text of the instance."""
        problem = self._problem
        things = (*self._domain.constants, *problem.objects)
        objects = []
        for root in (each.name for each in self._domain.types if each.parent is None):
            names = ", ".join(self._name("object", o.name) for o in things if self._root(o.type) == root)
            if not names:
                self._unsaid.note(f"`{problem.name}` has no object of the type `{root}`", None)
            objects.append(f"{self._type(root)}: {{{names}}};")
        fixed, begun = list(self._fixed(things)), list(self._facts(moving=True))
        facts = f"{self.instance}_facts"
        discount = print_float(problem.discount)
        return (
            f"// Written by `cleancli convert` from a .nid file.\nnon-fluents {facts} {{\n"
            f"    domain = {self.title};\n    objects {{\n{_indented(objects)}    }};\n"
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
                    yield f"{self._is('type', kind)}({self._name('object', thing.name)});"
        for name in self._singled:
            yield f"{self._is('constant', name)}({self._name('object', name)});"
        yield from self._facts(moving=False)
        for closure in self._formulas.closures.values():
            base = self._symbols[closure.closure or ""]
            for pair in sorted(closure_of(self._problem.state, base.name, base.symmetric)):
                arguments = ", ".join(self._name("object", name) for name in pair)
                yield f"{self._fluent(closure.name)}({arguments});"

    def _facts(self, *, moving: bool) -> Iterator[str]:
        """The facts about what can change, or about what never does; symmetric ones both ways round."""
        for fact in sorted(self._problem.state, key=lambda f: (f.symbol, f.objects)):
            symbol = self._symbols[fact.symbol]
            if (symbol.name in self._formulas.changed) is not moving:
                continue
            ways = {fact.objects, fact.objects[::-1]} if symbol.symmetric else {fact.objects}
            for names in sorted(ways):
                arguments = f"({', '.join(self._name('object', name) for name in names)})" if names else ""
                value = "" if symbol.is_predicate else f" = {self._value(symbol, fact.value)}"
                yield f"{self._fluent(symbol.name)}{arguments}{value};"

    # ---- what has to be told

    def notes(self) -> tuple[str, ...]:
        """What the files do not say as the .nid files do."""
        found = []
        outcomes = [outcome for ruled in self._rules for outcome, _ in ruled.outcomes]
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
        return {old: new for (kind, old), new in self._given.items() if kind in kinds and old != new}


def _variables_of(ruled: _Ruled) -> Iterator[Term]:
    """All variables that have to do with a rule."""
    yield from ruled.rule.variables
    for _, changes in ruled.outcomes:
        for change in changes:
            yield from (*change.variables, *change.terms, *free_variables(change.guard))


def _indented(lines: Sequence[str]) -> str:
    return "".join(f"        {part}\n" for line in lines for part in line.split("\n"))


def _number(value: Fraction) -> str:
    """A number as RDDL writes it."""
    text = print_fraction(abs(value))
    decimal = f"{value.numerator}.0 / {value.denominator}.0".lstrip("-") if "/" in text else text
    return f"-{decimal}" if value < 0 else decimal
