"""Formulas as RDDL writes them, and what it calls all that they speak of."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from fractions import Fraction

from cleancli.conversion.export.formulas import Formulas
from cleancli.conversion.export.names import Naming, Predicates
from cleancli.conversion.export.written import counted
from cleancli.conversion.pddl.formula import Both, Either, Formula, Quantified, apart, negated
from cleancli.language.model import Domain, Equality, Literal, Object, Problem, Symbol, Term, Value, Variable
from cleancli.language.printing.printer import print_fraction

WORDS = frozenset(
    {
        "Bernoulli",
        "Beta",
        "Binomial",
        "Cauchy",
        "ChiSquare",
        "DiracDelta",
        "Dirichlet",
        "Discrete",
        "Exponential",
        "Gamma",
        "Geometric",
        "Gompertz",
        "Gumbel",
        "KronDelta",
        "Kumaraswamy",
        "Laplace",
        "Multinomial",
        "MultivariateNormal",
        "MultivariateStudent",
        "NegativeBinomial",
        "Normal",
        "Pareto",
        "Poisson",
        "Student",
        "Uniform",
        "UnnormDiscrete",
        "Weibull",
        "abs",
        "action-fluent",
        "action-preconditions",
        "argmax",
        "argmin",
        "avg",
        "bool",
        "case",
        "cdfs",
        "cholesky",
        "col",
        "cpfs",
        "default",
        "det",
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
        "pinverse",
        "policy",
        "pow",
        "prod",
        "pvariables",
        "real",
        "requirements",
        "reward",
        "round",
        "row",
        "sgn",
        "sqrt",
        "state-fluent",
        "state-invariants",
        "sum",
        "switch",
        "terminal",
        "termination",
        "then",
        "true",
        "types",
    }
)
"""Words of the language, with those that pyRDDLGym reserves, and `noise`, which is none of .nid names."""


class FormulaWriter:
    """Writes formulas of a domain and a problem; each thing has one name in both files, whatever its kind.

    `given` has the names by kinds and the names in .nid files, `singled` the objects that something names,
    with their types; `noise` is the predicate that noise makes true, if any.
    """

    def __init__(self, domain: Domain, problem: Problem, noise: str | None) -> None:
        self._domain, self.noise = domain, noise
        self._naming = Naming(WORDS, folded=False)
        self.given: dict[tuple[str, str], str] = {}
        self.singled: dict[str, str] = {}
        self._symbols = {symbol.name: symbol for symbol in domain.symbols}
        # Formulas speak of predicates; `_said` tells which symbol, and which of its values, each stands for.
        naming = Naming((), folded=False)
        predicates = Predicates(naming, lambda symbol, value: f"{symbol}={value}")
        self._said: dict[str, tuple[str, Value]] = {}
        for symbol in domain.symbols:
            values: Sequence[Value | None] = [None] if symbol.is_predicate else symbol.values
            self._said |= {
                predicates.of(symbol.name, v): (symbol.name, True if v is None else v) for v in values
            }
        self.formulas = Formulas(domain, predicates, [counted(domain, problem)])

    # ---- names

    def name(self, kind: str, name: str) -> str:
        """What something is called; names end in a letter or digit and have no two underscores in a row."""
        if (kind, name) not in self.given:
            self.given[kind, name] = self._naming.fresh(re.sub("_+", "_", name).strip("_") or "n")
        return self.given[kind, name]

    def root(self, kind: str) -> str:
        """The type above all others that a type is below, or is."""
        parents = {each.name: each.parent for each in self._domain.types}
        while (parent := parents[kind]) is not None:
            kind = parent
        return kind

    def type_of(self, kind: str) -> str:
        """The type of RDDL that a type is."""
        return self.name("type", self.root(kind))

    def mark(self, kind: str, name: str) -> str:
        """The non-fluent that is true of the objects of a narrower type, or of one constant."""
        return self.name(f"is {kind}", f"is_{name}")

    def value_of(self, symbol: Symbol, value: Value) -> str:
        """A value of a symbol."""
        if isinstance(value, int):
            return str(value).lower()
        return f"@{self.name('value', f'{symbol.name}_{value}')}"

    def range_of(self, symbol: Symbol) -> str:
        """What kind of values a symbol has."""
        first = symbol.values[0]
        if isinstance(first, bool):
            return "bool"
        return "int" if isinstance(first, int) else self.name("range", f"{symbol.name}_value")

    def variable(self, variable: Variable) -> str:
        """A variable."""
        return "?" + self.name("variable", variable.name)

    # ---- conditions

    def formula(self, formula: Formula, *, after: bool = False) -> str:
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
                return f"~{self.formula(negated(formula), after=after)}"
            case Quantified(exists, variables, part):
                inner = self.formula(part, after=after)
                fits = self.fits(variables)
                if not exists:
                    said = f"[{' ^ '.join(fits)}] => {inner}" if fits else inner
                    return f"(forall_{{{self.typed(variables)}}} [{said}])"
                return f"(exists_{{{self.typed(variables)}}} [{' ^ '.join([*fits, inner])}])"

    def _joined(self, sign: str, parts: Sequence[Formula], none: str, *, after: bool) -> str:
        texts = [self.formula(part, after=after) for part in parts]
        return texts[0] if len(texts) == 1 else f"({sign.join(texts)})" if texts else none

    def _literal(self, predicate: str, terms: Sequence[Term], *, after: bool) -> str:
        name, value = self._said.get(predicate, (predicate, True))
        variables, constants = self.for_constants(terms)
        prime = "'" if after and (name in self.formulas.changed or name == self.noise) else ""
        called = f"{self.fluent(name)}{prime}{self.arguments(variables)}"
        said = called if value is True else f"({called} == {self.value_of(self._symbols[name], value)})"
        if not constants:
            return said
        return f"(exists_{{{self.typed([*constants])}}} [{' ^ '.join([*self.chosen(constants), said])}])"

    def fluent(self, name: str) -> str:
        """What a symbol is called, or noise."""
        return self.noise if name == self.noise and self.noise is not None else self.name("symbol", name)

    def for_constants(
        self, terms: Sequence[Term], scope: Sequence[Variable] = ()
    ) -> tuple[list[Variable], dict[Variable, str]]:
        """The terms, each constant replaced by a variable that `scope` has not, and the constants by these
        variables."""
        found: list[Variable] = []
        constants: dict[Variable, str] = {}
        for term in terms:
            if isinstance(term, Object):
                met = [*scope, *(other for other in terms if isinstance(other, Variable))]
                self.singled[term.name] = term.type
                variable = apart(Variable(f"the_{term.name}", term.type), met)
                constants[variable] = term.name
                found.append(variable)
            else:
                found.append(term)
        return found, constants

    def chosen(self, constants: Mapping[Variable, str]) -> list[str]:
        """That variables stand for these constants."""
        return [f"{self.mark('constant', c)}({self.variable(v)})" for v, c in constants.items()]

    def _same(self, left: Term, right: Term) -> str:
        if isinstance(left, Variable) and isinstance(right, Variable):
            return f"({self.variable(left)} == {self.variable(right)})"
        variable, constant = (left, right) if isinstance(left, Variable) else (right, left)
        assert isinstance(variable, Variable)
        self.singled[constant.name] = constant.type
        return f"{self.mark('constant', constant.name)}({self.variable(variable)})"

    def typed(self, variables: Sequence[Variable]) -> str:
        """Variables with their types, as quantifiers have them."""
        return ", ".join(f"{self.variable(each)}: {self.type_of(each.type)}" for each in variables)

    def fits(self, variables: Sequence[Variable]) -> list[str]:
        """That variables stand for objects of their types, where these are narrower than those of RDDL."""
        narrow = [each for each in variables if self.root(each.type) != each.type]
        return [f"{self.mark('type', each.type)}({self.variable(each)})" for each in narrow]

    def arguments(self, variables: Sequence[Variable]) -> str:
        """The variables that a fluent is of."""
        return f"({', '.join(map(self.variable, variables))})" if variables else ""

    def some(self, variables: Sequence[Variable], texts: Sequence[str]) -> str:
        """That all texts hold for some objects."""
        said = " ^ ".join(text for text in texts if text != "true") or "true"
        return f"(exists_{{{self.typed(variables)}}} [{said}])" if variables else f"({said})"


def number(value: Fraction) -> str:
    """A number as RDDL writes it."""
    text = print_fraction(abs(value))
    decimal = f"{value.numerator}.0 / {value.denominator}.0".lstrip("-") if "/" in text else text
    return f"-{decimal}" if value < 0 else decimal


def indented(lines: Sequence[str]) -> str:
    """Lines of a block, each with its line end."""
    return "".join(f"        {part}\n" for line in lines for part in line.split("\n"))
