"""E309: outcomes that do the same are found however they are spelt, and no others are.

Random outcomes are rewritten in ways that change nothing, and must be found; whatever is found must do the
same by the reference semantics in every state that is tried.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from random import Random

import pytest

from cleancli.compiler.fluents import Fluent
from cleancli.compiler.lifted import ConflictError
from cleancli.compiler.lifted_state import StateView
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.load import checked_domain, load_domain
from cleancli.language.model import Domain, Fact, Object, State, Value

TEXT = """\
domain alike {{
  types      {{ thing; part - thing }}
  constants  {{ one - thing }}
  predicates {{ p(?x - thing)  q(?x - thing)  near(?x ?y - thing) [symmetric]  on(?x ?y - thing) }}
  functions  {{ load(?x - thing): 0..2 }}
  derived    {{ loaded := count ?x - thing: load(?x) = 2 }}
  actions    {{ act(?x ?y - thing) }}
  rule r: act(?x, ?y) {{
    when {condition}
    then 0.4: {first}
         0.6: {second}
  }}
  reward {{ decrease(loaded) }}
}}
"""
CONDITIONS = (
    ("p(?x)",),
    ("p(?x)", "load(?x) = 2"),
    ("q(?y)", "?x != ?y"),
    ("?x = ?y", "not p(?x)"),
    ("near(?x, ?y)", "load(?y) = 0", "not q(?x)"),
)


@dataclass(frozen=True)
class Literal:
    """A literal of a condition or an effect: `head`, its terms, and what follows it."""

    head: str
    terms: tuple[str, ...]
    tail: str = ""
    sign: str = ""

    def text(self) -> str:
        return f"{self.sign}{self.head}({', '.join(self.terms)}){self.tail}"

    def renamed(self, names: dict[str, str]) -> Literal:
        return replace(self, terms=tuple(names.get(term, term) for term in self.terms))

    def turned(self) -> Literal:
        return replace(self, terms=self.terms[::-1]) if self.head == "near" else self


@dataclass(frozen=True)
class Differ:
    """`?a != ?b`."""

    terms: tuple[str, str]

    def text(self) -> str:
        return " != ".join(self.terms)

    def renamed(self, names: dict[str, str]) -> Differ:
        one, other = (names.get(term, term) for term in self.terms)
        return Differ((one, other))

    def turned(self) -> Differ:
        return Differ((self.terms[1], self.terms[0]))


@dataclass(frozen=True)
class Item:
    """Effects, for all bindings of `variables` (with their type) that fit; for none, one plain effect."""

    effects: tuple[Literal, ...]
    variables: tuple[tuple[str, str], ...] = ()
    condition: tuple[Literal | Differ, ...] = ()

    def text(self) -> str:
        effects = ", ".join(effect.text() for effect in self.effects)
        if not self.variables:
            return effects
        condition = ", ".join(part.text() for part in self.condition)
        bound = " ".join(f"{name} - {kind}" for name, kind in self.variables)
        return f"forall {bound}{': ' + condition if condition else ''} => ({effects})"


def random_literal(rng: Random, terms: Sequence[str]) -> Literal:
    match rng.randrange(6):
        case 0 | 1:
            return Literal(rng.choice("pq"), (rng.choice(terms),), sign=rng.choice(("", "not ")))
        case 2 | 3:
            head = rng.choice(("near", "near", "on"))
            return Literal(head, (rng.choice(terms), rng.choice(terms)), sign=rng.choice(("", "not ")))
        case _:
            return Literal("load", (rng.choice(terms),), f" = {rng.randint(0, 2)}")


def random_effect(rng: Random, terms: Sequence[str]) -> Literal:
    found = random_literal(rng, terms)
    if found.head != "load":
        return found
    return replace(found, tail=rng.choice((" += 1", " += 1", " -= 1", " += 2", " := 1")))


def random_outcome(rng: Random) -> tuple[Item, ...]:
    items = []
    for _ in range(rng.randint(1, 3)):
        if rng.random() < 0.5:
            items.append(Item((random_effect(rng, ("?x", "?y")),)))
            continue
        variables = (("?m", rng.choice(("thing", "part"))), ("?k", "thing"))[: rng.randint(1, 2)]
        names = [name for name, _ in variables]
        condition: list[Literal | Differ] = [
            random_literal(rng, [*names, *names, "?x", "one"]) for _ in range(rng.randint(0, 2))
        ]
        condition += [Differ((names[0], "?x"))] if rng.random() < 0.3 else []
        effects = [random_effect(rng, [*names, *names, "?y"]) for _ in range(rng.randint(1, 2))]
        items.append(Item(tuple(effects), variables, tuple(condition)))
    return tuple(items)


def rewritten(items: tuple[Item, ...], rng: Random) -> tuple[Item, ...]:
    """The same in other words."""
    found: list[Item] = []
    for item in items:
        names = dict(zip(("?m", "?k"), rng.sample(("?m", "?k", "?u", "?w"), 2), strict=True))
        if not item.variables:
            names = {}
        variables = tuple((names.get(name, name), kind) for name, kind in item.variables)
        if rng.random() < 0.5:
            variables = variables[::-1]
        condition = [part.renamed(names) for part in item.condition]
        condition = [part.turned() if rng.random() < 0.5 else part for part in condition]
        rng.shuffle(condition)
        effects = [effect.renamed(names) for effect in item.effects]
        effects = [effect.turned() if rng.random() < 0.5 else effect for effect in effects]
        rng.shuffle(effects)
        groups = [(effect,) for effect in effects] if rng.random() < 0.5 else [tuple(effects)]
        found += [Item(group, variables, tuple(condition)) for group in groups]
    rng.shuffle(found)
    return tuple(found)


def checked(condition: Sequence[str], first: tuple[Item, ...], second: tuple[Item, ...]) -> set[str]:
    """The codes of the mistakes that are found."""
    outcomes = [", ".join(item.text() for item in items) for items in (first, second)]
    text = TEXT.format(condition=", ".join(condition), first=outcomes[0], second=outcomes[1])
    found = checked_domain(Source("alike.nid", text)).diagnostics
    return {each.code for each in found if each.code.startswith("E")}


def model(condition: Sequence[str], items: tuple[Item, ...]) -> Domain | None:
    """The domain with one of the outcomes beside noise; None where it is refused."""
    text = TEXT.format(
        condition=", ".join(condition), first=", ".join(item.text() for item in items), second="noise"
    )
    try:
        return load_domain(Source("alike.nid", text))
    except Refused:
        return None


OBJECTS = (Object("a", "thing"), Object("b", "part"), Object("c", "part"))
NAMES = ("a", "b", "c", "one")


def random_state(rng: Random) -> State:
    share = rng.choice((0.3, 0.5, 0.8))
    facts = [Fact(symbol, (name,)) for symbol in "pq" for name in NAMES if rng.random() < share]
    pairs = [(one, two) for one in NAMES for two in NAMES]
    facts += [Fact("on", pair) for pair in pairs if rng.random() < share]
    facts += [Fact("near", pair) for pair in pairs if pair[0] <= pair[1] and rng.random() < share]
    return frozenset([*facts, *(Fact("load", (name,), rng.randint(0, 2)) for name in NAMES)])


def does(domain: Domain, state: State, arguments: tuple[str, str]) -> dict[Fluent, Value] | str:
    """What the first outcome changes, or that it does not apply or conflicts."""
    view = StateView(domain, OBJECTS, state)
    found = view.covering("act", arguments)
    if found is None:
        return "does not apply"
    try:
        changes = view.rules[0].changes[0](view.state, tuple(found[1].values()))
    except ConflictError:
        return "conflict"
    return {key: value for key, value in changes.items() if view.value(key) != value}


def tell_apart(one: Domain, other: Domain, rng: Random, states: int) -> bool:
    """Whether some state was found in which the outcomes of the two do different things."""
    for _ in range(states):
        state = random_state(rng)
        arguments = (rng.choice(NAMES), rng.choice(NAMES))
        if does(one, state, arguments) != does(other, state, arguments):
            return True
    return False


@pytest.mark.parametrize("seed", range(120))
def test_the_same_in_other_words_is_found(seed: int) -> None:
    rng = Random(seed)
    condition, items = rng.choice(CONDITIONS), random_outcome(rng)
    if model(condition, items) is None:
        return  # other mistakes come first
    assert "E309" in checked(condition, items, rewritten(items, rng))


def test_what_is_found_does_the_same() -> None:
    """Small outcomes, so that many are alike by chance; none that a state tells apart may be refused."""
    rng = Random(8)
    alike = 0
    for _ in range(250):
        condition = rng.choice(CONDITIONS)
        first = random_outcome(rng)[:2]
        second = (
            tuple(rewritten(first, rng)[: rng.randint(1, 2)]) if rng.random() < 0.7 else random_outcome(rng)
        )
        one, other = model(condition, first), model(condition, second)
        if one is None or other is None or "E309" not in checked(condition, first, second):
            continue
        alike += 1
        assert not tell_apart(one, other, rng, 80), [item.text() for item in (*first, *second)]
    assert alike > 60


@pytest.mark.parametrize(
    ("condition", "first", "second"),
    [
        ("p(?x)", "forall ?m - thing: q(?m) => not q(?m)", "forall ?k - thing: q(?k) => not q(?k)"),
        ("p(?x)", "near(?x, ?y)", "near(?y, ?x)"),
        ("p(?x)", "forall ?m - thing: near(?m, ?x) => q(?m)", "forall ?m - thing: near(?x, ?m) => q(?m)"),
        (
            "p(?x)",
            "forall ?m - thing => (q(?m), p(?m))",
            "forall ?m - thing => p(?m), forall ?k - thing => q(?k)",
        ),
        ("p(?x)", "load(?x) += 1, load(?x) += 1", "load(?x) += 2"),
        ("p(?x)", "load(?x) += 1, load(?x) -= 1", "nothing"),
        ("p(?x)", "forall ?m - thing: p(?x), q(?m) => not q(?m)", "forall ?m - thing: q(?m) => not q(?m)"),
        ("p(?x)", "forall ?m - thing: not p(?x) => q(?m)", "nothing"),
        ("p(?x)", "forall ?m - thing: q(?m) => q(?m)", "nothing"),
        ("?x = ?y", "forall ?m - thing: ?x != ?y => q(?m)", "nothing"),
        ("?x = ?y", "forall ?m - thing: ?x = ?y => q(?m)", "forall ?m - thing => q(?m)"),
        ("?x = ?y", "q(?x)", "q(?y)"),
    ],
)
def test_found_whatever_the_spelling(condition: str, first: str, second: str) -> None:
    text = TEXT.format(condition=condition, first=first, second=second)
    found = [each.code for each in checked_domain(Source("alike.nid", text)).diagnostics]
    assert "E309" in found


@pytest.mark.parametrize(
    ("condition", "first", "second"),
    [
        ("p(?x)", "load(?x) += 1, load(?x) += 1", "load(?x) += 1"),
        ("load(?x) = 2", "load(?x) += 1, load(?y) -= 1", "load(?y) -= 1"),  # where ?x is ?y
        ("p(?x)", "p(?x), forall ?m - thing: q(?m) => not p(?m)", "forall ?m - thing: q(?m) => not p(?m)"),
        ("p(?x)", "forall ?m - thing: on(?m, ?x) => q(?m)", "forall ?m - thing: on(?x, ?m) => q(?m)"),
        ("p(?x)", "forall ?m - thing => q(?m)", "forall ?m - part => q(?m)"),
        ("p(?x)", "forall ?m - thing: ?m = ?x => q(?m)", "forall ?m - thing => q(?m)"),
        (
            "p(?x)",
            "forall ?m ?k - thing: on(?m, ?k) => load(?y) += 1",
            "forall ?m - thing: on(?m, ?m) => load(?y) += 1",
        ),
        ("p(?x)", "forall ?m - thing: q(?m) => (load(?y) += 1)", "load(?y) += 1"),
    ],
)
def test_not_the_same(condition: str, first: str, second: str) -> None:
    text = TEXT.format(condition=condition, first=first, second=second)
    found = checked_domain(Source("alike.nid", text)).diagnostics
    assert [each.code for each in found if each.code == "E309"] == []


def test_of_several_that_do_the_same_the_one_that_is_written_so_is_named() -> None:
    """The third outcome does what the first does, too, and is written as the second: that is nearer."""
    text = TEXT.format(condition="p(?x)", first="near(?x, ?y)", second="near(?y, ?x)")
    text = text.replace("0.6: near(?y, ?x)", "0.3: near(?y, ?x)\n         0.3: near(?y, ?x)")
    found = [each for each in checked_domain(Source("alike.nid", text)).diagnostics if each.code == "E309"]
    first = text.splitlines().index("    then 0.4: near(?x, ?y)") + 1
    same = f"where the rule applies, this does the same as the outcome in line {first}"
    assert [(each.message, each.help) for each in found] == [
        (same, "make them one outcome"),
        ("this result is listed twice", f"add its probability to the outcome in line {first + 1}"),
    ]
