"""The generated files are what they are made for: varied, oddly laid out, and free of mistakes."""

from __future__ import annotations

from random import Random

import generate

from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.load import load_domain, load_problem
from cleancli.scene.check import load_scene


def test_the_same_seed_gives_the_same_text() -> None:
    assert generate.domain(Random(7)) == generate.domain(Random(7))
    assert generate.scene(Random(7)) != generate.scene(Random(8))


def test_every_construct_turns_up() -> None:
    seen: set[str] = set()
    ends: set[str] = set()
    for seed in range(40):
        rng = Random(seed)
        domain, world = generate.domain(rng)
        for made in (domain, generate.problem(world, rng), generate.scene(rng)):
            seen |= set(made.tokens)
            ends |= {end for end in ("\r\n", "\n", "\r", "\ufeff", "\t", "#") if end in made.text}
    words = "types constants predicates functions derived actions rule when then rest prior seen forall not"
    words += " nothing noise default symmetric duration init horizon discount group scattered x - mm cm m"
    words += " static closure exists with parameters fixed slip cost min goal planner prada ready reach level"
    assert (
        set(words.split())
        | {"..", "+=", "-=", "+", "*"}
        | {"<", "<=", ">", ">=", "=", "!=", ":=", "=>", ";", "1/3"}
        <= seen
    )
    assert len(ends) == 6


def test_odd_layout_is_no_mistake() -> None:
    for seed in range(15):
        rng = Random(seed)
        made, world = generate.domain(rng)
        domain = load_domain(Source("domain", made.text))
        load_problem(Source("problem", generate.problem(world, rng).text), domain)
        load_scene(Source("scene", generate.scene(rng).text))


def test_comments_are_found_in_order() -> None:
    assert generate.comments_of("a # one \r\n# {two}\rb#three") == ["# one", "# {two}", "#three"]
