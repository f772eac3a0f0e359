"""What a step is paid, as RDDL says it of the state before and the state after."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction

from cleancli.conversion.export.rddl_formulas import FormulaWriter, number
from cleancli.conversion.export.rddl_rules import Ruled, happens, refuse_closures, results_of
from cleancli.conversion.export.unsaid import Unsaid
from cleancli.conversion.pddl.formula import ALWAYS, Formula
from cleancli.language.model import Action, Domain, Problem, RewardKind, RewardTerm, Variable


class RewardWriter:
    """Writes the reward of a domain, of whose rules the outcomes pay, too, with the goal of a problem."""

    def __init__(
        self, domain: Domain, problem: Problem, rules: Sequence[Ruled], texts: FormulaWriter, unsaid: Unsaid
    ) -> None:
        self._domain, self._problem, self._rules = domain, problem, rules
        self._texts, self._formulas, self._unsaid = texts, texts.formulas, unsaid

    def text(self) -> str:
        """The sum."""
        found = [text for term in self._domain.reward for text in self._paid(term)]
        found += [text for ruled in self._rules for text in self._by_outcomes(ruled)]
        return "\n        + ".join(found) or "0"

    def _paid(self, term: RewardTerm) -> Iterator[str]:
        """A term of the reward; parts that no outcome changes are left out of what a count has fallen."""
        weight = number(term.weight)
        match term.kind:
            case RewardKind.DECREASE | RewardKind.COUNT:
                (count,) = (each for each in self._domain.counts if each.name == term.count)
                with self._unsaid.of(None, f"the count `{count.name}`"):
                    formula = self._formulas.apart(self._formulas.condition(count.condition), count.variables)
                    refuse_closures(self._formulas, self._unsaid, None, f"the count `{count.name}`: ")
                    after = self._counted(count.variables, formula, after=True)
                    if term.kind is RewardKind.COUNT:
                        yield f"({weight}) * {after}"
                    else:
                        before = self._counted(count.variables, formula, after=False)
                        yield f"({weight}) * ({before} - {after})"
            case RewardKind.GOAL if self._problem.goal:
                of = f"the goal of `{self._problem.name}`"
                with self._unsaid.of(None, of):
                    goal = self._formulas.condition(self._problem.goal)
                    refuse_closures(self._formulas, self._unsaid, None, f"{of}: ")
                    before, after = self._texts.formula(goal), self._texts.formula(goal, after=True)
                    holds = "if ({}) then 1.0 else 0.0"
                    yield f"({weight}) * (({holds.format(after)}) - ({holds.format(before)}))"
            case RewardKind.GOAL:
                pass
            case RewardKind.COST | RewardKind.DURATION:
                for action in self._domain.actions:
                    price = action.cost if term.kind is RewardKind.COST else Fraction(action.duration or 0)
                    if price:
                        yield f"({number(term.weight * price)}) * {self._done(action)}"
                    if term.kind is RewardKind.COST:
                        yield from self._by_functions(action, term.weight)

    def _by_outcomes(self, ruled: Ruled) -> Iterator[str]:
        """What the outcomes of a rule pay by themselves."""
        for draw, place, _ in results_of(ruled):
            if price := draw.paid[place]:
                case = happens(ruled, draw, place, "true", self._texts)
                yield f"({number(price)}) * (if ({case}) then 1.0 else 0.0)"

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
                yield f"({number(amount)}) * " + (f"(sum_{{{bound}}} [{summed}])" if bound else summed)

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
