"""A problem as an instance of RDDL: its objects, what never changes, and what holds at first."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from cleancli.conversion.export.rddl_formulas import FormulaWriter, indented
from cleancli.conversion.export.unsaid import Unsaid
from cleancli.conversion.export.written import closure_of
from cleancli.language.model import Domain, Object, Problem
from cleancli.language.printing.printer import print_float


class InstanceWriter:
    """Writes a problem under the names of its domain's text, which has been written: it tells which objects
    are singled out, and of which closures there are facts."""

    def __init__(self, domain: Domain, problem: Problem, texts: FormulaWriter, unsaid: Unsaid) -> None:
        self._domain, self._problem = domain, problem
        self._texts, self._formulas, self._unsaid = texts, texts.formulas, unsaid

    def text(self, horizon: int) -> str:
        """The text, for so many steps."""
        problem = self._problem
        title, instance = (self._texts.name("file", each.name) for each in (self._domain, problem))
        things = (*self._domain.constants, *problem.objects)
        objects = []
        for root in (each.name for each in self._domain.types if each.parent is None):
            names = ", ".join(
                self._texts.name("object", o.name) for o in things if self._texts.root(o.type) == root
            )
            if not names:
                message = f"`{problem.name}` has no object of the type `{root}`"
                self._unsaid.note(message, help="add one, or take the type out of the domain")
            objects.append(f"{self._texts.type_of(root)}: {{{names}}};")
        fixed, begun = list(self._fixed(things)), list(self._facts(moving=True))
        facts = f"{instance}_facts"
        discount = print_float(problem.discount)
        return (
            f"// Written by `cleancli convert` from a .nid file.\nnon-fluents {facts} {{\n"
            f"    domain = {title};\n"
            + (f"    objects {{\n{indented(objects)}    }};\n" if objects else "")
            + (f"    non-fluents {{\n{indented(fixed)}    }};\n" if fixed else "")
            + f"}}\n\ninstance {instance} {{\n    domain = {title};\n    non-fluents = {facts};\n"
            + (f"    init-state {{\n{indented(begun)}    }};\n" if begun else "")
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
            base = self._formulas.symbols[closure.closure or ""]
            for pair in sorted(closure_of(self._problem.state, base.name, base.symmetric)):
                arguments = ", ".join(self._texts.name("object", name) for name in pair)
                yield f"{self._texts.fluent(closure.name)}({arguments});"

    def _facts(self, *, moving: bool) -> Iterator[str]:
        """The facts about what can change, or about what never does; symmetric ones both ways round."""
        for fact in sorted(self._problem.state, key=lambda f: (f.symbol, f.objects)):
            symbol = self._formulas.symbols[fact.symbol]
            if (symbol.name in self._formulas.changed) is not moving:
                continue
            ways = {fact.objects, fact.objects[::-1]} if symbol.symmetric else {fact.objects}
            for names in sorted(ways):
                arguments = (
                    f"({', '.join(self._texts.name('object', name) for name in names)})" if names else ""
                )
                value = "" if symbol.is_predicate else f" = {self._texts.value_of(symbol, fact.value)}"
                yield f"{self._texts.fluent(symbol.name)}{arguments}{value};"
