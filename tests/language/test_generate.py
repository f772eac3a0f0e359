"""The generated files are what they are made for: varied, oddly laid out, and free of mistakes."""

from __future__ import annotations

from random import Random

from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.load import load_domain, load_problem
from cleancli.scene.check import load_scene
from cleancli.study.check import load_study
from support import random_texts


def test_the_same_seed_gives_the_same_text() -> None:
    assert random_texts.domain(Random(7)) == random_texts.domain(Random(7))
    assert random_texts.scene(Random(7)) != random_texts.scene(Random(8))


def test_every_construct_turns_up() -> None:
    seen: set[str] = set()
    ends: set[str] = set()
    for seed in range(40):
        rng = Random(seed)
        domain, world = random_texts.domain(rng)
        for made in (
            domain,
            random_texts.problem(world, rng),
            random_texts.scene(rng),
            random_texts.study(rng),
        ):
            seen |= set(made.tokens)
            ends |= {end for end in ("\r\n", "\n", "\r", "\ufeff", "\t", "#") if end in made.text}
    words = "types constants predicates functions derived actions rule when then rest prior seen forall not"
    words += " nothing noise default symmetric duration init horizon discount group scattered x - mm cm m"
    words += " part compare quick first second study"
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
        made, world = random_texts.domain(rng)
        domain = load_domain(Source("domain", made.text))
        load_problem(Source("problem", random_texts.problem(world, rng).text), domain)
        load_scene(Source("scene", random_texts.scene(rng).text))
        load_study(Source("study", random_texts.study(rng).text))


def test_comments_are_found_in_order() -> None:
    assert random_texts.comments_of("a # one \r\n# {two}\rb#three") == ["# one", "# {two}", "#three"]
