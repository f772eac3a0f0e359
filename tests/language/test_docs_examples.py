"""Every example in docs/language.md is a whole file without mistakes or warnings, and prints as it reads."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from cleancli.language.diagnostics import Source
from cleancli.language.format import print_domain, print_problem
from cleancli.language.load import checked_domain, checked_problem, domain_named, kind_of, load_domain
from cleancli.language.render import render

PAGE = Path(__file__).parents[2] / "docs" / "language.md"
BLOCKS = re.findall(r"^```nid\n(.*?)^```$", PAGE.read_text(encoding="utf-8"), re.M | re.S)
NAMES = [block.split()[1] for block in BLOCKS]
TEXTS = dict(zip(NAMES, BLOCKS, strict=True))


def test_names_differ() -> None:
    assert len(TEXTS) == len(BLOCKS) >= 8


@pytest.mark.parametrize("name", NAMES)
def test_example(name: str) -> None:
    source = Source(name, TEXTS[name])
    if kind_of(source) == "domain":
        domain = checked_domain(source)
        assert render(domain.diagnostics, domain.sources) == ""
        model = domain.get()
        assert load_domain(Source("printed", print_domain(model))) == model
    else:
        of = load_domain(Source("domain", TEXTS[domain_named(source).text]))
        problem = checked_problem(source, of)
        assert render(problem.diagnostics, problem.sources) == ""
        again = checked_problem(Source("printed", print_problem(problem.get(), of)), of)
        assert again.get() == problem.get()
