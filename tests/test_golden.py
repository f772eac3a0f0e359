"""What each stage makes of fixed files, word for word (the parser: tests/language/test_parse.py).

CLEANCLI_REGENERATE=1 rewrites the expected texts; read the difference before keeping it.
"""

from __future__ import annotations

import difflib

import pytest

from cleancli.compiler.dump import dump
from cleancli.compiler.ground import ground
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.diagnostics.render import render
from cleancli.language.diagnostics.text_edit import apply_edits
from cleancli.language.load import load_domain, load_problem, read_source
from cleancli.language.model import Domain, Problem
from cleancli.language.printing.printer import print_domain
from cleancli.learning.edits import edits
from cleancli.learning.experience import read_experience
from cleancli.learning.learn import learn
from cleancli.planning.compiled_task import prepare
from cleancli.planning.plan import Options
from cleancli.planning.registry import PLANNERS
from support.golden import GOLDEN, check_golden


def source(name: str) -> Source:
    return Source(name, read_source(GOLDEN / name).text)


@pytest.fixture(scope="module")
def domain() -> Domain:
    return load_domain(source("domain.nid"))


@pytest.fixture(scope="module")
def problem(domain: Domain) -> Problem:
    return load_problem(source("problem.nid"), domain)


def test_check() -> None:
    with pytest.raises(Refused) as refused:
        load_domain(source("mistakes.nid"))
    check_golden("mistakes.txt", render(refused.value.diagnostics, refused.value.sources))


def test_print(domain: Domain) -> None:
    check_golden("domain.printed.nid", print_domain(domain))


def test_compile(domain: Domain, problem: Problem) -> None:
    check_golden("problem.task.txt", dump(ground(domain, problem)))


def test_plan(domain: Domain, problem: Problem) -> None:
    plan = PLANNERS["prada"](prepare(ground(domain, problem)), Options(samples=2000, seed=7))
    lines = [*(str(action) for action in plan.actions), f"value {plan.value:.6f}"]
    check_golden("problem.plan.txt", "\n".join(lines) + "\n")


def test_learn(domain: Domain) -> None:
    text = source("domain.nid").text
    learned = learn(domain, tuple(read_experience(GOLDEN / "experience.jsonl", domain))).rules
    new = apply_edits(text, edits(domain, [source("domain.nid")], learned))
    difference = difflib.unified_diff(text.splitlines(), new.splitlines(), "domain", "learned", lineterm="")
    check_golden("domain.learned.txt", "\n".join(difference) + "\n")
