"""What a step is paid, as RDDL says it of the state before and the state after."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction

from cleancli.conversion.export.payments import priced
from cleancli.conversion.export.rddl_formulas import FormulaWriter, number
from cleancli.conversion.export.rddl_rules import Ruled, happens, refuse_closures, results_of, when
from cleancli.conversion.export.unsaid import Unsaid
from cleancli.conversion.pddl.formula import ALWAYS, Formula
from cleancli.language.model import Action, Domain, Price, Problem, RewardKind, RewardTerm, Variable


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
                    lasts = Price(Fraction(action.duration or 0))
                    price = (action.cost if term.kind is RewardKind.COST else lasts).times(term.weight)
                    if price.number:
                        yield f"({number(price.number)}) * {self._done(action)}"
                    done = (
                        f"{self._texts.name('action', action.name)}{self._texts.arguments(action.parameters)}"
                    )
                    yield from self._by_functions(price, action.parameters, [done])

    def _by_outcomes(self, ruled: Ruled) -> Iterator[str]:
        """What the outcomes of a rule pay by themselves."""
        for draw, place, _ in results_of(ruled):
            price = draw.paid[place]
            if price.number:
                case = happens(ruled, draw, place, "true", self._texts)
                yield f"({number(price.number)}) * (if ({case}) then 1.0 else 0.0)"
            for payment in priced(Price(parts=price.parts), ruled.rule, self._formulas):
                bound = (*ruled.rule.variables, *payment.variables)
                fits = self._texts.formula(self._formulas.apart(payment.guard, bound))
                yield from self._by_functions(
                    payment.price, bound, [*when(ruled, draw, place, self._texts), fits]
                )

    def _by_functions(
        self, price: Price, variables: Sequence[Variable], happens: Sequence[str]
    ) -> Iterator[str]:
        """What functions say of a price, for the objects that the variables stand for where all of `happens`
        holds."""
        for part in price.parts:
            terms, constants = self._texts.for_constants(part.terms, variables)
            value = f"{self._texts.fluent(part.symbol)}{self._texts.arguments(terms)}"
            asked = [*happens, *self._texts.fits(variables), *self._texts.chosen(constants)]
            bound = self._texts.typed([*variables, *constants])
            summed = f"({' ^ '.join(each for each in asked if each != 'true')}) * {value}"
            yield f"({number(part.weight)}) * " + (f"(sum_{{{bound}}} [{summed}])" if bound else summed)

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
