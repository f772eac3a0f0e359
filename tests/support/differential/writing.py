"""The .nid text of a domain and a problem, spelt in one of many ways that mean the same."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from random import Random

from support.differential.abstract import (
    Action,
    AnyOf,
    Closure,
    Comparison,
    Count,
    Definition,
    Domain,
    Equality,
    Every,
    Exists,
    ForEach,
    Key,
    Literal,
    Outcome,
    Part,
    Payment,
    Price,
    Priced,
    Problem,
    Reference,
    Rule,
    Setting,
    SetTruth,
    SetValue,
    Symbol,
    Value,
    Variable,
)


def number(value: Fraction, random: Random) -> str:
    """A number as a decimal, where it has one, or as a ratio."""
    scaled = value * 10**6
    if scaled.denominator == 1 and random.random() < 0.8:
        text = f"{int(scaled):07d}"
        decimal = f"{text[:-6]}.{text[-6:]}".rstrip("0").rstrip(".")
        return decimal + random.choice(["", ".0"]) if value.denominator == 1 else decimal
    factor = random.choice([1, 1, 2, 3])
    return f"{value.numerator * factor}/{value.denominator * factor}"


def falls(price: Price) -> bool:
    """Whether a price of one sign takes away."""
    return price.number < 0 or any(part.weight < 0 for part in price.parts)


@dataclass(frozen=True, slots=True)
class Writer:
    random: Random

    def either(self, *texts: str) -> str:
        return self.random.choice(texts)

    # ---- declarations

    def variables(self, variables: Sequence[Variable]) -> str:
        """?a ?b - area, ?c - container: neighbours of one type may share it."""
        groups: list[tuple[list[str], str]] = []
        for each in variables:
            if groups and groups[-1][1] == each.kind and self.random.random() < 0.7:
                groups[-1][0].append(each.name)
            else:
                groups.append(([each.name], each.kind))
        between = self.either(", ", " ")
        return between.join(f"{' '.join(names)} - {kind}" for names, kind in groups)

    def objects(self, objects: Sequence[Variable]) -> str:
        return " ".join(f"{each.name} - {each.kind}" for each in objects)

    def kinds(self, kinds: Sequence[tuple[str, str | None]]) -> str:
        return "; ".join(name if above is None else f"{name} - {above}" for name, above in kinds)

    def symbol(self, symbol: Symbol) -> str:
        names = [f"?v{index}" for index in range(len(symbol.kinds))]
        head = self.variables([Variable(name, kind) for name, kind in zip(names, symbol.kinds, strict=True)])
        marks = ["symmetric"] * symbol.symmetric + ["static"] * symbol.static
        self.random.shuffle(marks)
        tail = f" [{', '.join(marks)}]" if marks else ""
        return f"{symbol.name}({head}){self.range(symbol)}{tail}"

    def range(self, symbol: Symbol) -> str:
        if not symbol.values:
            return ""
        if isinstance(symbol.values[0], int):
            return f": {symbol.values[0]}..{symbol.values[-1]}"
        return ": " + " < ".join(map(str, symbol.values))

    def derived(self, derived: Definition | Closure) -> str:
        head = f"{derived.name}({self.variables(derived.parameters)}) := "
        if isinstance(derived, Closure):
            return f"{head}closure {derived.of}"
        return head + self.condition(derived.condition)

    def count(self, count: Count) -> str:
        return f"{count.name} := count {self.variables(count.variables)}: {self.condition(count.condition)}"

    def action(self, action: Action) -> str:
        noted = self.either("", " [prior 9 s, seen 12.5]", " [seen 3]", " [fixed]")
        marks = [f"duration = {action.duration}{noted}"] if action.duration else []
        marks += [f"cost = {self.price(action.cost)}"] if action.cost is not None else []
        tail = f" [{', '.join(marks)}]" if marks else ""
        return f"{action.name}({self.variables(action.parameters)}){tail}"

    # ---- conditions

    def condition(self, parts: Iterable[Part]) -> str:
        return ", ".join(map(self.part, parts))

    def part(self, part: Part) -> str:
        if isinstance(part, AnyOf):
            return f"({' or '.join(map(self.literal, part.literals))})"
        if isinstance(part, Exists):
            word = "exists" if part.holds else "not exists"
            return f"{word} {self.variables(part.variables)}: {self.body(part.body)}"
        if isinstance(part, Every):
            guard = f"{self.body(part.guard)} => " if part.guard else ""
            return f"forall {self.variables(part.variables)}: {guard}{self.literal(part.then)}"
        return self.literal(part)

    def body(self, body: Sequence[Literal]) -> str:
        text = ", ".join(map(self.literal, body))
        return text if len(body) == 1 and self.random.random() < 0.7 else f"({text})"

    def literal(self, literal: Literal) -> str:
        if isinstance(literal, Equality):
            return f"{literal.left} {'=' if literal.same else '!='} {literal.right}"
        head = f"{literal.symbol}({', '.join(self.turned(literal.symbol, literal.terms))})"
        if isinstance(literal, Comparison):
            return f"{head} {literal.relation} {literal.value}"
        return head if literal.holds else f"not {head}"

    def turned(self, symbol: str, terms: tuple[str, ...]) -> tuple[str, ...]:
        """The objects of a symmetric predicate in either order."""
        return terms[::-1] if symbol.startswith("sym") and self.random.random() < 0.5 else terms

    # ---- rules

    def rule(self, rule: Rule) -> str:
        lines = [
            f"rule {rule.name}: {rule.action}({', '.join(each.name for each in rule.parameters)})"
            f"{' [fixed]' if rule.fixed else ''} {{"
        ]
        if rule.condition:
            lines.append(f"    when {self.condition(rule.condition)}")
        lines += [self.reference(reference) for reference in rule.references]
        first, *others = map(self.outcome, rule.outcomes)
        lines.append(f"    then {first}")
        lines += [f"         {other}" for other in others]
        return "\n".join([*lines, "  }"])

    def reference(self, reference: Reference) -> str:
        body = ", ".join(map(self.literal, reference.body))
        return f"    with {self.variables(reference.variables)}: {body}"

    def outcome(self, outcome: Outcome) -> str:
        marks = f" [{outcome.marks}]" if outcome.marks else ""
        said = [*map(self.effect, outcome.effects), *self.payments(outcome)]
        return f"{outcome.said}{marks}: {', '.join(said) or outcome.idle}"

    def payments(self, outcome: Outcome) -> list[str]:
        """A payment may be said in several parts, and is where some are added and others taken away."""
        said = [("reward", each) for each in self.apart(outcome.reward)]
        said += [("cost", each) for each in self.apart(outcome.cost)]
        texts = []
        for what, each in said:
            texts.append(f"{what} {'-=' if falls(each) else '+='} {self.price(each)}")
        return texts

    def apart(self, price: Price) -> list[Price]:
        """Prices that come to a price, each of one sign, a part in any of its sign; none is empty."""
        numbers = [price.number] if price.number else []
        if price.number > 1 and self.random.random() < 0.3:
            numbers = [Fraction(1), price.number - 1]
        found = [Price(each) for each in numbers]
        for part in price.parts:
            like = [i for i, each in enumerate(found) if (part.weight < 0) == falls(each)]
            if like and self.random.random() < 0.6:
                place = self.random.choice(like)
                found[place] = Price(found[place].number, (*found[place].parts, part))
            else:
                found.append(Price(parts=(part,)))
        return found

    def price(self, price: Price) -> str:
        """What a price of one sign comes to without it; 0 is written alone."""
        parts = [self.priced(part) for part in price.parts]
        constant = number(abs(price.number), self.random)
        return " + ".join([constant, *parts] if price.number or not parts else parts)

    def priced(self, part: Priced) -> str:
        weight = abs(part.weight)
        factor = "" if weight == 1 and self.random.random() < 0.8 else f"{number(weight, self.random)} * "
        return f"{factor}{part.symbol}({', '.join(part.terms)})"

    def effect(self, effect: Setting | ForEach) -> str:
        if not isinstance(effect, ForEach):
            return self.setting(effect)
        guard = ": " + ", ".join(map(self.literal, effect.guard)) if effect.guard else ""
        head = f"forall {self.variables(effect.variables)}{guard}" if effect.variables else f"if{guard[1:]}"
        settings = ", ".join(map(self.setting, effect.settings))
        settings = f"({settings})" if len(effect.settings) > 1 else settings
        return f"{head} => {settings}"

    def setting(self, setting: Setting) -> str:
        head = f"{setting.symbol}({', '.join(self.turned(setting.symbol, setting.terms))})"
        if isinstance(setting, SetTruth):
            return head if setting.holds else f"not {head}"
        if isinstance(setting, SetValue):
            return f"{head} := {setting.value}"
        return f"{head} {'+=' if setting.amount > 0 else '-='} {abs(setting.amount)}"

    def reward(self, reward: Sequence[Payment]) -> str:
        text = ""
        for payment in reward:
            sign = "-" if payment.weight < 0 else "+" if text else ""
            weight = abs(payment.weight)
            factor = "" if weight == 1 and self.random.random() < 0.8 else f"{number(weight, self.random)} * "
            what = {"decrease": f"decrease({payment.count})", "count": payment.count}.get(
                payment.kind, payment.kind
            )
            text += f" {sign} {factor}{what}" if sign else f" {factor}{what}"
        return f"reward {{{text} }}"

    # ---- whole files

    def domain(self, domain: Domain) -> tuple[str, str | None]:
        """The domain's text, and that of `base.nid`, where it includes one."""
        declared = self.declarations(domain)
        rules = [f"  {self.rule(rule)}" for rule in domain.rules]
        default = [f"  default {{ {domain.default} }}"] if domain.default else []
        reward = [f"  {self.reward(domain.reward)}"]
        if not domain.included:
            learned = self.either(
                "",
                "  learned { estimator = m  m = 2.5  match = strict }",
                '  learned { match = shared estimator = likelihood m = 0 experience "x" [sha256 = '
                '"0123456789abcdef", transitions = 3] }',
            )
            blocks = [*declared, *rules, *default, *reward, learned]
            self.random.shuffle(blocks)
            return "\n".join([f"domain {domain.name} {{", *blocks, "}", ""]), None
        other = (
            [f"  reward {{ 7 * {domain.counts[0].name} }}", "  default { 1: noise }"] if default else reward
        )
        base = "\n".join(["domain base {", *declared, *rules[: domain.included], *other, "}", ""])
        own = [*rules[domain.included :], *default, *(reward if default else [])]
        return "\n".join([f"domain {domain.name} {{", '  include "base.nid"', *own, "}", ""]), base

    def declarations(self, domain: Domain) -> list[str]:
        predicates = [self.symbol(each) for each in domain.symbols if not each.values]
        functions = [self.symbol(each) for each in domain.symbols if each.values]
        derived = [self.derived(each) for each in domain.derived]
        derived += [self.count(each) for each in domain.counts]
        shared = [f"{name} = {said}{f' [{marks}]' if marks else ''}" for name, said, marks in domain.shared]
        self.random.shuffle(derived)
        blocks = {
            "constants": [self.objects(domain.constants)] if domain.constants else [],
            "predicates": predicates,
            "functions": functions,
            "derived": derived,
            "parameters": shared,
            "actions": [self.action(action) for action in domain.actions],
        }
        lines = [f"  types {{ {self.kinds(domain.kinds)} }}"]
        for name, texts in blocks.items():
            if texts:
                lines.append("\n".join([f"  {name} {{", *(f"    {text}" for text in texts), "  }"]))
        return lines

    def problem(self, problem: Problem, domain: Domain) -> str:
        facts = [self.fact(key, value) for key, value in problem.facts if value is not False]
        between = self.either(", ", " ", "\n    ")
        blocks = [
            f"  domain = {domain.name}",
            f"  objects {{ {self.objects(problem.objects)} }}",
            f"  init {{\n    {between.join(facts)}\n  }}",
        ]
        if problem.goal:
            blocks.append(f"  goal {{ {self.condition(problem.goal)} }}")
        if problem.horizon is not None:
            said = [str(each) for each in problem.horizon if each is not None]
            blocks.append(f"  horizon = {' + '.join(said)}")
        if problem.discount is not None:
            blocks.append(f"  discount = {problem.discount}")
        return "\n".join([f"problem {problem.name} {{", *blocks, "}", ""])

    def fact(self, key: Key, value: Value) -> str:
        symbol, terms = key
        head = f"{symbol}({', '.join(self.turned(symbol, terms))})"
        return head if value is True else f"{head} = {value}"


def call(name: str, objects: tuple[str, ...]) -> str:
    return f"{name}({', '.join(objects)})"
