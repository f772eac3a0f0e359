"""Whole domains, problems and scenes as text, valid by construction and laid out oddly.

Each text is made twice from one list of tokens: plainly, one blank between tokens, and with any blanks, line
ends and comments that the language allows. The same state of the random generator gives the same text.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from random import Random

VALUES = ("none", "low", "mid", "high", "full")
REMARKS = ("", " twice", " { no block", " }", " größer als 3 ≤ 4", "# two signs", " rule r: a() {", "\ttab")
TIGHT = frozenset("(){}[],;")
SHARED = (("slip", Fraction(1, 100)), ("gain", Fraction(1, 5)))
"""The shared parameters of every generated domain."""


@dataclass(frozen=True, slots=True)
class Generated:
    """One file: its tokens, and they laid out."""

    tokens: tuple[str, ...]
    text: str

    @property
    def plain(self) -> str:
        return " ".join(self.tokens)


@dataclass(frozen=True, slots=True)
class Symbol:
    """A predicate (no values) or function with the types of its parameters."""

    name: str
    types: tuple[str, ...]
    values: tuple[str, ...] = ()
    symmetric: bool = False


@dataclass(frozen=True, slots=True)
class World:
    """What a generated domain declares; every type but the root is below the root."""

    types: tuple[str, ...]
    constants: tuple[tuple[str, str], ...]
    symbols: tuple[Symbol, ...]
    actions: tuple[tuple[str, tuple[str, ...]], ...]
    levels: range
    pays_goal: bool

    def fits(self, type_name: str, wanted: str) -> bool:
        return type_name == wanted or wanted == self.types[0]


Typed = Sequence[tuple[str, str]]
"""Terms as they are written, each with its type."""


# ---- layout


def comments_of(text: str) -> list[str]:
    """The comments of a text in order; no token but a comment can hold a `#`."""
    return [comment.rstrip() for comment in re.findall(r"#[^\r\n]*", text)]


def lay_out(tokens: Sequence[str], rng: Random) -> str:
    """The tokens with any blanks and comments between them that leave them what they are."""
    ends = rng.choice((("\n",), ("\r\n",), ("\r",), ("\n", "\r\n", "\r")))
    parts = [rng.choice(("", "", "\ufeff", "  ", _comment(rng, ends)))]
    for left, right in zip(tokens, (*tokens[1:], ""), strict=True):
        parts += [left, _between(left, right, rng, ends)]
    return "".join(parts)


def _between(left: str, right: str, rng: Random, ends: Sequence[str]) -> str:
    may_touch = left in TIGHT or right in TIGHT or not right
    choice = rng.random()
    if choice < 0.6:
        return "" if may_touch and rng.random() < 0.7 else " "
    if choice < 0.9:
        return "".join(rng.choice((" ", "\t", "\f", *ends)) for _ in range(rng.randint(1, 4)))
    return rng.choice(("", " ", "\t", *ends)) + _comment(rng, ends)


def _comment(rng: Random, ends: Sequence[str]) -> str:
    return f"#{rng.choice(REMARKS)}{rng.choice(ends)}"


def _generated(tokens: list[str], rng: Random) -> Generated:
    return Generated(tuple(tokens), lay_out(tokens, rng))


# ---- domains


def domain(rng: Random) -> tuple[Generated, World]:
    """A domain, and what it declares."""
    world = _world(rng)
    blocks = [_types(world), _constants(world, rng), _symbols(world, rng), _actions(world, rng)]
    counts = [*_count("total", world, rng), *_count("other", world, rng)]
    blocks += [["derived", "{", *_derived(world, rng), *counts, "}"], _shared(rng)]
    blocks += [_rules(action, types, world, rng) for action, types in world.actions]
    blocks.append(_reward(world, rng))
    blocks.append(_learned(rng))
    if rng.random() < 0.5:
        blocks.append(["default", "{", *_chances([["nothing"], ["noise"]], rng), "}"])
    rng.shuffle(blocks)
    tokens = ["domain", "generated", "{", *(token for block in blocks for token in block), "}"]
    return _generated(tokens, rng), world


def _world(rng: Random) -> World:
    types = ("thing", *(f"type{n}" for n in range(rng.randint(1, 3))))
    constants = tuple((f"fixed{n}", rng.choice(types)) for n in range(rng.randint(0, 2)))
    symbols = []
    for number in range(rng.randint(2, 5)):
        arity = tuple(rng.choice(types) for _ in range(rng.choice((0, 1, 1, 2, 3))))
        symmetric = len(arity) == 2 and arity[0] == arity[1] and rng.random() < 0.6
        symbols.append(Symbol(f"p{number}", arity, (), symmetric))
    for number in range(rng.randint(1, 2)):
        values = VALUES[: rng.randint(2, len(VALUES))]
        symbols.append(Symbol(f"f{number}", (types[0],), values))
    actions = tuple(
        (f"act{number}", tuple(rng.choice(types) for _ in range(rng.randint(0, 3))))
        for number in range(rng.randint(1, 4))
    )
    low = rng.randint(-3, 2)
    levels = range(low, low + rng.randint(2, 9))
    return World(types, constants, tuple(symbols), actions, levels, rng.random() < 0.5)


def _types(world: World) -> list[str]:
    root, *others = world.types
    below = [token for name in others for token in (";", name, "-", root)]
    return ["types", "{", root, *below, "}"]


def _constants(world: World, rng: Random) -> list[str]:
    if not world.constants and rng.random() < 0.5:
        return []
    return ["constants", "{", *(token for name, kind in world.constants for token in (name, "-", kind)), "}"]


def _parameters(names: Sequence[str], types: Sequence[str], rng: Random) -> list[str]:
    tokens: list[str] = []
    for place, (name, kind) in enumerate(zip(names, types, strict=True)):
        tokens.append(f"?{name}")
        is_last = place + 1 == len(types)
        if is_last or types[place + 1] != kind or rng.random() < 0.5:
            tokens += ["-", kind]
            tokens += [","] if not is_last and rng.random() < 0.5 else []
    return tokens


def _symbols(world: World, rng: Random) -> list[str]:
    predicates, functions = ["predicates", "{"], ["functions", "{"]
    for symbol in world.symbols:
        head = [symbol.name, "(", *_parameters("abc"[: len(symbol.types)], symbol.types, rng), ")"]
        if symbol.values:
            functions += [*head, ":", *_joined([[value] for value in symbol.values], "<")]
        else:
            predicates += [*head, *(("[", "symmetric", "]") if symbol.symmetric else ())]
    root = world.types[0]
    predicates += ["mark", "(", "?a", "-", root, ")"]
    marks = rng.choice((["static"], ["static", ",", "symmetric"]))
    predicates += ["link", "(", "?a", "?b", "-", root, ")", "[", *marks, "]"]
    functions += ["level", "(", "?a", "-", root, ")", ":"]
    functions += [*_integer(world.levels[0]), "..", *_integer(world.levels[-1])]
    return [*predicates, "}", *functions, "}"]


def _integer(value: int) -> list[str]:
    return ["-", str(-value)] if value < 0 else [str(value)]


def _derived(world: World, rng: Random) -> list[str]:
    """Derived predicates, none of which can be always or never true."""
    root = world.types[0]
    head = ["(", "?a", "-", root, ")", ":="]
    closure = ["reach", "(", "?a", "?b", "-", root, ")", ":=", "closure", "link"]
    alone = ["alone", *head, "not", "exists", "?n", "-", root, ":", "link", "(", "?a", ",", "?n", ")"]
    ready = ["ready", *head, "mark", "(", "?a", ")", ",", "not", "alone", "(", "?a", ")"]
    parts = [closure, alone, ready]
    rng.shuffle(parts)
    return [token for part in parts for token in part]


def _shared(rng: Random) -> list[str]:
    tokens = ["parameters", "{"]
    for name, value in SHARED:
        marks = rng.choice(([], ["fixed"], ["prior", "0.25"], ["seen", "12.4375", ",", "prior", "1/3"]))
        tokens += [
            name,
            "=",
            f"{value.numerator}/{value.denominator}",
            *(("[", *marks, "]") if marks else ()),
        ]
    return [*tokens, "}"]


def _learned(rng: Random) -> list[str]:
    """What the counts rest on; settings and experience in any order."""
    if rng.random() < 0.5:
        return []
    entries = [
        ["estimator", "=", rng.choice(("decreasing_m", "m", "fitted_m", "likelihood"))],
        ["m", "=", rng.choice(("0", "10", "2.5", "1000000"))],
        ["match", "=", rng.choice(("shared", "strict"))],
    ]
    for number, name in enumerate(
        rng.sample(('"runs/one-001"', '"a {b} [c].jsonl"', '""'), rng.randint(0, 3))
    ):
        digest = f'"{number}{rng.randrange(16**15):015x}"'
        lines = rng.choice(("1", "35", "1000000000"))
        entries.append(["experience", name, "[", "sha256", "=", digest, ",", "transitions", "=", lines, "]"])
    rng.shuffle(entries)
    return ["learned", "{", *(token for entry in entries for token in entry), "}"]


def _reward(world: World, rng: Random) -> list[str]:
    """Some of the terms that there are, each at most once; one is the fall of a count, which is wanted."""
    terms, fall = [["decrease", "(", "other", ")"], ["total"], ["cost"]], ["decrease", "(", "total", ")"]
    chosen = [fall, *rng.sample(terms, rng.randint(0, 3))]
    chosen += [["goal"]] if world.pays_goal else []
    rng.shuffle(chosen)
    tokens: list[str] = []
    for place, term in enumerate(chosen):
        sign = rng.choice(("+", "-")) if place else rng.choice(("", "-"))
        if term is fall:
            sign = "+" if place else ""
        weight = rng.choice(([], ["2", "*"], ["0.5", "*"], ["1/3", "*"]))
        tokens += [*([sign] if sign else []), *weight, *term]
    return ["reward", "{", *tokens, "}"]


def _actions(world: World, rng: Random) -> list[str]:
    tokens = ["actions", "{"]
    for name, types in world.actions:
        tokens += [name, "(", *_parameters("xyz"[: len(types)], types, rng), ")"]
        if rng.random() < 0.5:
            length = [rng.choice(("9", "0.25", "14.2", "10000.125")), rng.choice(("s", "min"))]
            noted = rng.choice(
                ([], [["prior", *length]], [["seen", "12.4"], ["prior", "9", "s"]], [["fixed"]])
            )
            length += ["[", *_joined(noted, ","), "]"] if noted else []
            marks = [["duration", "=", *length], ["cost", "=", rng.choice(("0", "2", "1/3"))]]
            tokens += ["[", *_joined(rng.sample(marks, rng.randint(1, 2)), ","), "]"]
    return [*tokens, "}"]


def _joined(parts: Sequence[Sequence[str]], separator: str) -> list[str]:
    return [token for place, part in enumerate(parts) for token in ((separator, *part) if place else part)]


def _count(name: str, world: World, rng: Random) -> list[str]:
    kind = rng.choice(world.types)
    literals = _literals(_applications(world, [("?v", kind), *world.constants], rng)[:2], rng)
    return [name, ":=", "count", "?v", "-", kind, ":", *_joined(literals, ",")]


# ---- rules


def _applications(world: World, terms: Typed, rng: Random) -> list[tuple[Symbol, list[str]]]:
    """Symbols with terms that fit, each symbol at most once, in random order."""
    found = []
    for symbol in rng.sample(world.symbols, len(world.symbols)):
        choices = [[name for name, kind in terms if world.fits(kind, wanted)] for wanted in symbol.types]
        if all(choices):
            found.append((symbol, [rng.choice(names) for names in choices]))
    return found


def _literals(applied: Sequence[tuple[Symbol, list[str]]], rng: Random) -> list[list[str]]:
    return [rng.choice(_cases(symbol, terms, rng)) for symbol, terms in applied]


def _applied(symbol: Symbol, terms: Sequence[str]) -> list[str]:
    return [symbol.name, "(", *_joined([[term] for term in terms], ","), ")"]


def _cases(symbol: Symbol, terms: Sequence[str], rng: Random) -> list[list[str]]:
    """Literals that exclude each other, each of them possible."""
    head = _applied(symbol, terms)
    if not symbol.values:
        return [head, ["not", *head]]
    if rng.random() < 0.5:
        return [[*head, "=", value] for value in symbol.values]
    cut = rng.randrange(1, len(symbol.values))
    low, high = symbol.values[cut - 1], symbol.values[cut]
    below, above = rng.choice((("<", high), ("<=", low))), rng.choice(((">", low), (">=", high)))
    return [[*head, *below], [*head, *above]]


def _rules(action: str, types: Sequence[str], world: World, rng: Random) -> list[str]:
    """Rules of an action that exclude each other: they differ in the case of one literal."""
    terms = [*((f"?{place}", kind) for place, kind in enumerate(types)), *world.constants]
    applied = _applications(world, terms, rng)
    cases = _cases(*applied[0], rng) if applied and rng.random() < 0.8 else [[]]
    tokens: list[str] = []
    for number, case in enumerate(rng.sample(cases, rng.randint(1, len(cases)))):
        literals = [case] if case else []
        literals += _literals(applied[1 : rng.randint(1, 3)], rng)
        if len(types) > 1 and types[0] == types[1] and rng.random() < 0.3:
            literals.append(["?0", "!=", "?1"])
        results = _results(terms, literals, world, rng)
        literals += _quantified(terms, world, rng)
        rng.shuffle(literals)
        names = rng.sample(("a", "b", "c", "d_1", "E"), len(types))
        head = ["rule", f"{action}_{number}", ":", action, "("]
        head += [*_joined([[f"?{place}"] for place in range(len(types))], ","), ")"]
        is_fixed = rng.random() < 0.3
        head += ["[", "fixed", "]", "{"] if is_fixed else ["{"]
        when = ["when", *_joined(literals, ",")] if literals else []
        chances = _chances(results, rng, () if is_fixed else SHARED)
        rule = [*head, *when, *_reference(terms, world, rng), "then", *chances, "}"]
        tokens += [f"?{names[int(token[1:])]}" if re.match(r"\?\d", token) else token for token in rule]
    return tokens


def _quantified(terms: Typed, world: World, rng: Random) -> list[list[str]]:
    """At most one part that speaks of what no literal does: it fits any other."""
    one = rng.choice([name for name, _ in terms] or ["?q"])
    root, low = world.types[0], _integer(world.levels[1])
    some = ["?q", "-", root, ":"]
    link, mark = ["link", "(", one, ",", "?q", ")"], ["mark", "(", "?q", ")"]
    guarded = ["forall", *some, *mark, "=>", "level", "(", "?q", ")", ">=", *low]
    parts = [
        ["exists", *some, "(", *link, ",", *mark, ")"],
        ["not", "exists", *some, *mark],
        ["exists", *some, "level", "(", "?q", ")", "<", *low],
        ["forall", *some, "not", *mark],
        guarded,
    ]
    either = ["(", "ready", "(", one, ")", "or", "not", "reach", "(", one, ",", one, ")", ")"]
    parts += [either, ["ready", "(", one, ")"], ["not", "reach", "(", one, ",", one, ")"]] if terms else []
    return [rng.choice(parts)] if rng.random() < 0.5 else []


def _reference(terms: Typed, world: World, rng: Random) -> list[str]:
    """Perhaps the one object with a level, or that is linked to a term."""
    if rng.random() < 0.6:
        return []
    one = rng.choice([name for name, _ in terms] or ["?w"])
    level = ["level", "(", "?w", ")", "=", *_integer(world.levels[0])]
    tokens = ["with", "?w", "-", world.types[0], ":"]
    return [*tokens, *rng.choice((level, ["link", "(", "?w", ",", one, ")", ",", *level]))]


def _results(terms: Typed, condition: list[list[str]], world: World, rng: Random) -> list[list[str]]:
    """What may happen: no two alike, and no effect that the condition makes idle."""
    results = [["noise"], ["nothing"]][: rng.randint(0, 2)]
    told: set[frozenset[str]] = set()
    for _ in range(rng.randint(1, 3)):
        effects = [_effect(*application, rng) for application in _applications(world, terms, rng)[:2]]
        effects = [effect for effect in effects if not _is_idle(effect, condition)]
        if rng.random() < 0.4:
            effects += _forall(terms, effects, world, rng)
        if rng.random() < 0.2:
            effects += _if(terms, effects, world, rng)
        if terms and rng.random() < 0.3:
            head = ["level", "(", rng.choice(terms)[0], ")"]
            value = [":=", *_integer(world.levels[-1])]
            effects.append([*head, *rng.choice((["+=", "1"], ["-=", "2"], value))])
        if rng.random() < 0.2:
            effects.append([*rng.choice((["reward", "+="], ["reward", "-="], ["cost", "+="])), "2/3"])
        same = frozenset(" ".join(effect) for effect in effects)
        if effects and same not in told:
            told.add(same)
            results.append(_joined(effects, ","))
    results = results or [["noise"]]
    rng.shuffle(results)
    return results


def _is_idle(effect: list[str], condition: list[list[str]]) -> bool:
    """Whether the effect sets a predicate to what a literal asks for, or a function that one asks about."""
    if ":=" not in effect:
        negated = effect[0] == "not"
        return any((part[0] == "not") == negated and sorted(part) == sorted(effect) for part in condition)
    head = effect[: effect.index(":=")]
    return any(part[: len(head)] == head for part in condition)


def _effect(symbol: Symbol, terms: Sequence[str], rng: Random) -> list[str]:
    head = _applied(symbol, terms)
    if symbol.values:
        return [*head, ":=", rng.choice(symbol.values)]
    return rng.choice((head, ["not", *head]))


def _forall(terms: Typed, beside: Sequence[Sequence[str]], world: World, rng: Random) -> list[list[str]]:
    """An effect for everything that fits; it sets nothing that those `beside` it set, and
    always something."""
    kind = rng.choice(world.types)
    inner = [("?m", kind), *terms]
    about_it = [each for each in _applications(world, inner, rng) if "?m" in each[1]]
    condition = _joined(_literals(about_it[: rng.randint(0, 2)], rng), ",")
    taken = {token for effect in beside for token in effect}
    may_set = [
        (symbol, chosen)
        for symbol, chosen in _applications(world, inner, rng)
        if "?m" in chosen or symbol.name not in taken
    ]
    effects = [_effect(*application, rng) for application in may_set[-2:]]
    effects = effects[rng.randint(0, 2) :]
    effects.append(["level", "(", "?m", ")", rng.choice(("+=", "-=")), rng.choice(("1", "2", "3"))])
    listed = ["(", *_joined(effects, ","), ")"] if len(effects) > 1 or rng.random() < 0.3 else effects[0]
    return [["forall", "?m", "-", kind, *((":", *condition) if condition else ()), "=>", *listed]]


def _if(terms: Typed, beside: Sequence[Sequence[str]], world: World, rng: Random) -> list[list[str]]:
    """An effect with a condition, if there is one that sets nothing that those `beside` it set."""
    condition = _literals(_applications(world, terms, rng)[:1], rng)
    taken = {token for effect in beside for token in effect}
    may_set = [each for each in _applications(world, terms, rng) if each[0].name not in taken]
    if not condition or not may_set:
        return []
    effect = _effect(*may_set[0], rng)
    return [["if", *_joined(condition, ","), "=>", *(effect if rng.random() < 0.7 else ["(", *effect, ")"])]]


def _chances(
    results: Sequence[Sequence[str]], rng: Random, shared: Sequence[tuple[str, Fraction]] = ()
) -> list[str]:
    """The results with probabilities that sum to 1, as decimals, fractions and perhaps a `rest`.

    Where a `rest` takes up what is left, one of the `shared` parameters may stand for a number above it.
    """
    whole = rng.choice((10, 1000, 3, 7, 360))
    cuts = sorted(rng.randint(0, whole) for _ in results[1:])
    shares = [high - low for low, high in zip([0, *cuts], [*cuts, whole], strict=True)]
    rest = rng.randrange(len(results)) if rng.random() < 0.6 else None
    tokens = []
    for place, (share, result) in enumerate(zip(shares, results, strict=True)):
        smaller = [name for name, value in shared if value <= Fraction(share, whole)]
        if rest not in (None, place) and smaller and rng.random() < 0.4:
            tokens += [rng.choice(smaller), ":", *result]
            continue
        decimal = whole in (10, 1000) and rng.random() < 0.8
        tokens.append("rest" if place == rest else str(share / whole) if decimal else f"{share}/{whole}")
        marks = rng.choice(
            ([], [["prior", "0.25"]], [["seen", "12.4"], ["prior", "1/3"]], [["seen", "0"]], [["fixed"]])
        )
        if place == rest:  # which has no prior of its own
            marks = [mark for mark in marks if mark[0] != "prior"]
        tokens += ["[", *_joined(marks, ","), "]"] if marks else []
        tokens += [":", *result]
    return tokens


# ---- problems


def problem(world: World, rng: Random) -> Generated:
    """A problem for a generated domain."""
    objects = [(f"o{number}", rng.choice(world.types)) for number in range(rng.randint(1, 4))]
    everything = [*objects, *world.constants]
    listed = [token for name, kind in objects for token in (name, "-", kind)]
    blocks = [["domain", "=", "generated"], ["objects", "{", *listed, "}"]]
    blocks.append(["init", "{", *_facts(world, everything, rng), "}"])
    with_goal = world.pays_goal or rng.random() < 0.4
    if rng.random() < 0.7:
        unlimited = [["unlimited"]] * with_goal
        horizon = rng.choice([["7"], ["total"], ["1", "+", "total"], *unlimited])
        blocks.append(["horizon", "=", *horizon])
    if rng.random() < 0.7:
        blocks.append(["discount", "=", rng.choice(("1", "0", "0.95", "0.1234567890123456"))])
    if with_goal:
        blocks.append(["goal", "{", *_goal(world, rng), "}"])
    if rng.random() < 0.5:
        settings = [["name", "=", "prada"], ["samples", "=", "500"], ["seed", "=", "3"]]
        chosen = rng.sample(settings, rng.randint(1, 3))
        blocks.append(["planner", "{", *(token for setting in chosen for token in setting), "}"])
    rng.shuffle(blocks)
    tokens = ["problem", "p", "{", *(token for block in blocks for token in block), "}"]
    return _generated(tokens, rng)


def _goal(world: World, rng: Random) -> list[str]:
    some, mark = ["?g", "-", world.types[0], ":"], ["mark", "(", "?g", ")"]
    level = ["level", "(", "?g", ")", ">", *_integer(world.levels[0])]
    goals = (
        ["forall", *some, *mark],
        ["not", "exists", *some, "(", *mark, ",", *level, ")"],
        ["mark", "(", "o0", ")"],
    )
    return rng.choice(goals)


def _facts(world: World, objects: Typed, rng: Random) -> list[str]:
    facts = []
    for symbol in world.symbols:
        fitting = [[name for name, kind in objects if world.fits(kind, wanted)] for wanted in symbol.types]
        for names in product(*fitting):
            if symbol.values:
                facts.append([*_applied(symbol, names), "=", rng.choice(symbol.values)])
            elif rng.random() < 0.3:
                facts.append(_applied(symbol, names))
    for name, _ in objects:
        facts.append(["level", "(", name, ")", "=", *_integer(rng.choice(world.levels))])
        facts += [["mark", "(", name, ")"]] if rng.random() < 0.4 else []
        facts += [["link", "(", "o0", ",", name, ")"]] if rng.random() < 0.4 else []
    rng.shuffle(facts)
    return [token for fact in facts for token in (*fact, *rng.choice(((), (",",))))]


# ---- scenes


def scene(rng: Random) -> Generated:
    """A scene; what it leaves out has a default."""
    blocks = [["domain", "=", "cleaning"], ["seed", "=", str(rng.randrange(2**31))]]
    blocks += [
        _section("surface", rng, width=_length(rng, 600, 1000), depth=_length(rng, 550, 750)),
        _section("container", rng, edge=[rng.choice(("east", "north", "south", "west"))]),
        _section("container", rng, width=_length(rng, 200, 320), offset=_length(rng, -100, 100)),
        _section("rag", rng, width=_length(rng, 40, 200)),
        _section("camera", rng, height=_length(rng, 900, 1200), image=["640", "x", "480"]),
        ["grasp", "own", *_section("", rng, sweep=_angle(rng), skew=_angle(rng), gain=["0.2"])[1:]],
        _section("light", rng, direction=["(", *_angle(rng), ",", "60", "deg", ")"], gradient=["0.3"]),
        _section("symbols", rng, near=_length(rng, 100, 300), link=_length(rng, 10, 90)),
    ]
    del blocks[rng.choice((3, 4))]
    chosen = [block for block in blocks if rng.random() < 0.7]
    chosen.append(["dirt", "{", *(t for _ in range(rng.randint(1, 4)) for t in _dirt(rng)), "}"])
    rng.shuffle(chosen)
    return _generated(["scene", "s", "{", *(t for block in chosen for t in block), "}"], rng)


def _section(name: str, rng: Random, **settings: list[str]) -> list[str]:
    kept = [[key, "=", *value] for key, value in settings.items() if rng.random() < 0.7]
    rng.shuffle(kept)
    return [name, "{", *(token for setting in kept for token in setting), "}"]


def _length(rng: Random, low: int, high: int) -> list[str]:
    """A length between two numbers of mm, in any unit."""
    value = rng.randint(low, high)
    sign, size = (["-"] if value < 0 else []), abs(value)
    number, unit = rng.choice(((str(size), "mm"), (f"{size / 10}", "cm"), (f"{size / 1000}", "m")))
    return [*sign, number, unit]


def _angle(rng: Random) -> list[str]:
    """From 0 to 40 degrees in any unit."""
    return rng.choice(([f"{rng.randint(0, 40)}", "deg"], [f"{rng.random() * 0.6:.3f}", "rad"]))


def _point(rng: Random, low: int, high: int) -> list[str]:
    return ["(", *_length(rng, low, high), ",", *_length(rng, low, high), ")"]


def _dirt(rng: Random) -> list[str]:
    if rng.random() < 0.2:
        points = [token for _ in range(rng.randint(1, 4)) for token in (*_point(rng, -200, 200), ",")]
        return ["ink", "{", "along", "=", "(", *points[:-1], ")", "}"]
    count = ["count", "=", str(rng.randint(1, 40))]
    count += rng.choice(([], ["of", "=", rng.choice(("lentils", "rice", "peas", "blocks"))]))
    if rng.random() < 0.5:
        place = ["at", "=", *_point(rng, -200, 200), "radius", "=", *_length(rng, 10, 40)]
        return ["group", "{", *count, *place, "}"]
    corners = ["from", "=", *_point(rng, -200, -10), "to", "=", *_point(rng, 10, 200)]
    return ["scattered", "{", *count, *corners, "}"]


# ---- studies

_OPTIONS = {
    "scene": ("two_groups", "scattered_40", '"own table.nid"'),
    "strategy": ("plan_1", "plan_2", "reactive"),
    "planner": ("prada_plus", "uct"),
    "estimator": ("none", "decreasing_m", "m"),
    "m": ("3", "10", "0.5"),
    "samples": ("100", "2000"),
}


def study(rng: Random) -> Generated:
    """A study whose axes all have a value, with parts, a quick form and comparisons of what there is."""
    axes = {axis: rng.sample(values, rng.randint(1, len(values))) for axis, values in _OPTIONS.items()}
    widths = _listed("width", [" ".join(_length(rng, 40 + 50 * n, 80 + 50 * n)) for n in range(3)])
    blocks = [_listed(axis, values) for axis, values in axes.items()]
    blocks += [_listed("runs", ["7"]), ["about", "=", '"why not"'], ["rag", "{", *widths, "}"]]
    for name in ("one", "two"):
        link = ["symbols", "{", "link", "=", *_length(rng, 10, 90), "}"]
        blocks.append(["part", name, "{", *(link if rng.random() < 0.7 else ()), "}"])
    if rng.random() < 0.7:
        blocks.append(["quick", "{", "runs", "=", "1", *_listed("scene", ["two_groups"]), "}"])
    for number in range(rng.randint(0, 2)):
        second = [["limit", "=", "30"], ["second", "{", *_listed("part", ["two"]), "}"]][number]
        first = ["first", "{", *_listed("strategy", axes["strategy"][:2]), "}"]
        parts = [first, second, ["claim", "=", "3"], _listed("episode", ["1", "2"]), ["says", "=", '"so"']]
        rng.shuffle(parts)
        blocks.append(["compare", f"c{number}", "{", *(token for part in parts for token in part), "}"])
    rng.shuffle(blocks)
    return _generated(["study", "s", "{", *(t for block in blocks for t in block), "}"], rng)


def _listed(key: str, values: Sequence[str]) -> list[str]:
    """A key with its values; one of several tokens has blanks between them."""
    tokens = [token for value in values for token in (",", *_tokens(value))]
    return [key, "=", *tokens[1:]]


def _tokens(value: str) -> list[str]:
    return [value] if value.startswith('"') else value.split()
