"""From names to what they mean: types, objects, predicates, and conditions as formulas over them.

What is not declared is declared where its meaning is plain (W911), and otherwise a mistake (E916).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from cleancli.conversion.pddl.formula import (
    ALWAYS,
    NEVER,
    Formula,
    apart,
    both,
    either,
    equality,
    free_variables,
    literal,
    named_apart,
    negated,
    quantified,
)
from cleancli.conversion.pddl.naming import Naming, readable
from cleancli.conversion.pddl.read_conditions import name_of
from cleancli.conversion.pddl.syntax import (
    AndNode,
    AtomNode,
    CompareNode,
    ConditionNode,
    DomainNode,
    EqualNode,
    Name,
    NotNode,
    ObjectsNode,
    OrNode,
    ProblemNode,
    QuantifiedNode,
    Signature,
    Typed,
)
from cleancli.conversion.pddl.types import Types
from cleancli.language.diagnostics.diagnostic import Source, Span
from cleancli.language.diagnostics.plural import plural
from cleancli.language.diagnostics.sink import Findings, meant
from cleancli.language.model import Object, Term, Variable


@dataclass(frozen=True, slots=True)
class Scope:
    """What each variable of PDDL stands for at a place, an object where a `forall` is written out, and each
    name of an object in a problem, since others may have it too; and all that variables around the place
    stand for, also those of which a nearer one has the name."""

    terms: Mapping[str, Term] = field(default_factory=dict)
    around: tuple[Term, ...] = ()

    def inside(self, terms: Mapping[str, Term]) -> Scope:
        """The scope where more variables are bound."""
        return Scope({**self.terms, **terms}, (*self.around, *terms.values()))


NO_VARIABLES = Scope()


@dataclass(slots=True)
class Predicate:
    """A predicate under its name in .nid files. The types of its parameters grow where it is used of more
    than what it is declared for."""

    name: str
    variables: tuple[str, ...]
    types: list[str]

    @property
    def parameters(self) -> tuple[Variable, ...]:
        """Its parameters."""
        return tuple(map(Variable, self.variables, self.types))


class Words:
    """All names of a domain and its problems, and what they mean.

    `constants` are the domain's, `objects` those of each problem; `named` tells where an object was first
    named. `is_open`: there is no problem, and what one alone says may be missing.
    """

    def __init__(
        self,
        domain: DomainNode,
        problems: Sequence[ProblemNode],
        findings: Findings,
        sources: Mapping[str, Source],
        *,
        is_open: bool = False,
    ) -> None:
        self.findings = findings
        self.is_open = is_open
        self.types = Types(domain, findings, Naming(sources))
        self.symbols = Naming(sources)
        self.actions = Naming(sources)
        self._names = Naming(sources)
        self._is_alone = not problems
        self.constants = self._declared(domain.constants, domain.span.path, {})
        self._constant_names = {constant.name for constant in self.constants.values()}
        self.objects = [
            self._declared(problem.objects, problem.span.path, self.constants) for problem in problems
        ]
        self._known = {
            name: thing for each in (self.constants, *self.objects) for name, thing in each.items()
        }
        self.named: dict[Object, Span] = {}
        self.predicates: dict[str, Predicate] = {}
        for signature in domain.predicates:
            self._declare(signature)

    # ---- objects

    @property
    def everything(self) -> tuple[Object, ...]:
        """The constants and the objects of all problems, each once."""
        found = [*self.constants.values(), *(thing for each in self.objects for thing in each.values())]
        return tuple(dict.fromkeys(found) if len(self.objects) > 1 else found)

    def _declared(
        self, nodes: Iterable[ObjectsNode], path: str, constants: Mapping[str, Object]
    ) -> dict[str, Object]:
        """The objects that stand in the file at `path`."""
        found: dict[str, Object] = {}
        for node in nodes:
            kind, members = self.types.of(node.types)
            if members:
                message = f"it is not said which of several types `{node.words[0].text}` is of"
                self.findings.error("E917", message, node.types[0].span)
            for word in node.words:
                name = word.text
                first = found.get(name) or constants.get(name)
                if first is None:
                    found[name] = Object(self._names.of_text(name, path, word.start, "o"), kind)
                elif first.type == kind:
                    span = name_of(word, path).span
                    self.findings.warning("W911", f"`{name}` is declared twice", span, "passed over")
                else:
                    message = f"`{name}` is declared with another type before"
                    self.findings.error("E916", message, name_of(word, path).span)
        return found

    def of_type(self, kind: str) -> tuple[Object, ...] | None:
        """The objects of a type that all problems have; None where they have different ones, or where there
        is no problem."""
        found = {
            tuple(
                thing
                for thing in (*self.constants.values(), *each.values())
                if self.types.is_a(thing.type, kind)
            )
            for each in self.objects
        }
        return next(iter(found)) if len(found) == 1 else None

    # ---- predicates

    def _declare(self, signature: Signature) -> None:
        name = signature.name
        types = [self.types.of(parameter.types)[0] for parameter in signature.parameters]
        first = self.predicates.get(name.text)
        if first is not None:
            if first.types != types:
                self.findings.error("E916", f"the predicate `{name.text}` is declared in two ways", name.span)
            else:
                message = f"the predicate `{name.text}` is declared twice"
                self.findings.warning("W911", message, name.span, "passed over")
            return
        self.predicates[name.text] = self.declared_as(signature, self.symbols.of(name, "p"))

    def declared_as(self, signature: Signature, name: str) -> Predicate:
        """The predicate or function that a signature declares, under a name of .nid files."""
        variables: list[Variable] = []
        for parameter in signature.parameters:
            variables.append(apart(Variable(readable(parameter.name.text, "v"), ""), variables))
        types = [self.types.of(parameter.types)[0] for parameter in signature.parameters]
        return Predicate(name, tuple(variable.name for variable in variables), types)

    def predicate(self, atom: AtomNode, terms: Sequence[Term]) -> Predicate:
        """The predicate of an atom, after it was noted of what it is used."""
        name = atom.symbol.text
        predicate = self.predicates.get(name)
        if predicate is None:
            predicate = self._undeclared(atom, terms)
        elif len(predicate.types) != len(terms):
            takes = plural(len(predicate.types), "term")
            self.findings.error("E916", f"`{name}` takes {takes}, not {len(terms)}", atom.span)
            return Predicate(predicate.name, (), [])
        for place, term in enumerate(terms):
            if term.type != predicate.types[place]:
                self._fit(predicate, place, term, atom)
        return predicate

    def _undeclared(self, atom: AtomNode, terms: Sequence[Term]) -> Predicate:
        name = atom.symbol
        help = meant(name.text, self.predicates, "predicate")
        if help.startswith("did you mean"):
            self.findings.error("E916", f"unknown predicate `{name.text}`", name.span, help=help)
        else:
            message = f"the predicate `{name.text}` is not declared"
            self.findings.warning("W911", message, name.span, "declared for what it is used of")
        letters = "xyz" if len(terms) <= 3 else ""
        names = tuple(letters[: len(terms)]) or tuple(f"x{n}" for n in range(1, len(terms) + 1))
        predicate = Predicate(self.symbols.of(name, "p"), names, [term.type for term in terms])
        self.types.mentioned.update(predicate.types)
        self.predicates[name.text] = predicate
        return predicate

    def _fit(self, predicate: Predicate, place: int, term: Term, atom: AtomNode) -> None:
        kind = predicate.types[place]
        if self.types.is_a(term.type, kind):
            return
        what = (
            f"`{atom.terms[place].text}` is of type `{term.type}`, and `{atom.symbol.text}` is for `{kind}`"
        )
        if self.types.is_a(kind, term.type):
            predicate.types[place] = term.type
            self.types.mentioned.add(term.type)
            self.findings.warning("W911", what, atom.terms[place].span, f"taken to be for `{term.type}`")
        else:
            self.findings.error("E916", what, atom.terms[place].span)

    # ---- terms and conditions

    def term(self, name: Name, scope: Scope) -> Term | None:
        """What a term stands for; None, and E916, for nothing that is known."""
        if name.is_variable:
            bound = scope.terms.get(name.text)
            if bound is None:
                help = meant(name.text, scope.terms, "variable")
                self.findings.error("E916", f"the variable `{name.text}` is not bound", name.span, help=help)
            return bound
        thing = scope.terms.get(name.text) or self._known.get(name.text)
        if not isinstance(thing, Object):
            help = meant(name.text, self._known, "object")
            self.findings.error("E916", f"unknown object `{name.text}`", name.span, help=help)
        else:
            self.named.setdefault(thing, name.span)
        return thing

    def atom(self, node: AtomNode, scope: Scope) -> tuple[str, tuple[Term, ...]] | None:
        """The predicate and terms of an atom; None after a mistake."""
        terms = [term for each in node.terms if (term := self.term(each, scope)) is not None]
        if len(terms) < len(node.terms):
            return None
        predicate = self.predicate(node, terms)
        return (predicate.name, tuple(terms)) if len(predicate.types) == len(terms) else None

    def bound(self, typed: Sequence[Typed], scope: Scope) -> tuple[tuple[Variable, ...], Scope, Formula]:
        """The variables of a quantifier or a schema, the scope inside of it, and what `either` asks of the
        variables. No variable has the name of another around it, or of an object."""
        taken = {term.name for term in scope.around} | self._constant_names
        own, asked = dict[str, Variable](), list[Formula]()
        for each in typed:
            if each.name.text in own:
                self.findings.error("E916", f"`{each.name.text}` is bound twice here", each.name.span)
            kind, members = self.types.of(each.types)
            variable = named_apart(Variable(readable(each.name.text, "v"), kind), taken)
            taken.add(variable.name)
            own[each.name.text] = variable
            asked.append(self._of_types(variable, members))
        return tuple(own.values()), scope.inside(own), both(asked)

    def _of_types(self, variable: Variable, members: tuple[str, ...]) -> Formula:
        """That what a variable stands for is of one of some types; always true for none of them, and where
        all objects that it may stand for are."""
        if not members:
            return ALWAYS
        fitting = [thing for thing in self.everything if self.types.is_a(thing.type, variable.type)]
        others = [o for o in fitting if not any(self.types.is_a(o.type, one) for one in members)]
        if self.objects and not others:
            return ALWAYS
        parts = []
        for kind in members:
            one = Variable(f"{kind}_{variable.name}", kind)
            parts.append(quantified(True, [one], equality(one, variable, self.types.may_be_one)))
        return either(parts)

    def formula(self, node: ConditionNode, scope: Scope) -> Formula:
        """What a condition says; after a mistake, something that it does not say."""
        match node:
            case AndNode(parts):
                return both([self.formula(part, scope) for part in parts])
            case OrNode(parts):
                return either([self.formula(part, scope) for part in parts])
            case NotNode(part):
                return negated(self.formula(part, scope))
            case EqualNode():
                left, right = self.term(node.left, scope), self.term(node.right, scope)
                if left is None or right is None:
                    return ALWAYS
                return equality(left, right, self.types.may_be_one)
            case QuantifiedNode():
                return self._quantified(node, scope)
            case AtomNode():
                found = self.atom(node, scope)
                return ALWAYS if found is None else literal(*found)
            case CompareNode():
                message = "numbers are not compared in .nid conditions that are converted"
                self.findings.error("E917", message, node.span)
                return ALWAYS

    def _quantified(self, node: QuantifiedNode, scope: Scope) -> Formula:
        variables, inner, asked = self.bound(node.variables, scope)
        part = self.formula(node.part, inner)
        missing = [v for v in variables if self.is_empty(v.type)]
        if missing:
            return NEVER if node.exists else ALWAYS
        whole = both([asked, part]) if node.exists else either([negated(asked), part])
        if whole != (NEVER if node.exists else ALWAYS):
            self.warn_of_empty([v for v in variables if v not in free_variables(whole)], node.span)
        return quantified(node.exists, variables, whole)

    def warn_of_empty(self, left_out: Iterable[Variable], span: Span) -> None:
        """W912 for variables that a quantifier leaves out, of types of which a problem may have no object."""
        for variable in left_out:
            if self.of_type(variable.type) == () or self._has_each(variable.type):
                continue
            message = f"this is read as if every problem had an object of type `{variable.type}`"
            help = "give the problem too; of several, one at a time"
            self.findings.warning("W912", message, span, help=help)

    def _has_each(self, kind: str) -> bool:
        """Whether it is known that each problem has an object of a type."""
        each_has = [[*self.constants.values(), *own.values()] for own in self.objects or [{}]]
        return all(any(self.types.is_a(thing.type, kind) for thing in has) for has in each_has)

    def is_empty(self, kind: str) -> bool:
        """Whether no problem has an object of a type."""
        every = [*self.constants.values(), *(thing for each in self.objects for thing in each.values())]
        return not self._is_alone and not any(self.types.is_a(thing.type, kind) for thing in every)
