"""Every example in docs/language.md is a whole file without mistakes or warnings, and prints as it reads."""

from __future__ import annotations

import re
from dataclasses import astuple
from pathlib import Path

import pytest

from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.render import render
from cleancli.language.load import checked_domain, checked_problem, domain_named, kind_of, load_domain
from cleancli.language.printing.printer import print_domain, print_problem
from cleancli.scene.check import load_scene
from cleancli.scene.format import print_scene
from cleancli.scene.grasps import SHIPPED

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
    elif kind_of(source) == "scene":
        scene = load_scene(source)
        assert load_scene(Source("printed", print_scene(scene))) == scene
    else:
        of = load_domain(Source("domain", TEXTS[domain_named(source).text]))
        problem = checked_problem(source, of)
        assert render(problem.diagnostics, problem.sources) == ""
        again = checked_problem(Source("printed", print_problem(problem.get(), of)), of)
        assert again.get() == problem.get()


def test_the_table_of_grasps_is_what_ships() -> None:
    text = PAGE.read_text(encoding="utf-8").split("### Grasps")[1]
    names, rows = (
        re.search(r"^\| grasp (\|.+)$", text, re.M),
        re.findall(r"^\| `(\w+)` \|(.+)\|$", text, re.M),
    )
    assert names is not None
    keys = [key.strip() for key in names.group(1).strip("|").split("|")]
    assert len(rows) == len(SHIPPED)
    for name, row in rows:
        settings = "  ".join(
            f"{key} = {value.strip()}" for key, value in zip(keys, row.split("|"), strict=True)
        )
        text = f"scene s {{ grasp own {{ {settings} }} dirt {{ ink {{ along = (0 m, 0 m) }} }} }}"
        (own,) = load_scene(Source("s", text)).grasps
        assert astuple(own)[1:] == pytest.approx(astuple(SHIPPED[name])[1:])
