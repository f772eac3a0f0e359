"""The layout changes no text's meaning: of the shipped files with any line ends, and of generated ones."""

from __future__ import annotations

from pathlib import Path
from random import Random

import pytest

from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.load import load_domain, load_problem, read_source
from cleancli.language.parsing.parse import parse
from cleancli.language.printing.formatter import layout
from cleancli.resources import shipped
from cleancli.scene.check import load_scene
from cleancli.study.check import load_study
from support import random_texts

KINDS = ("domains", "problems", "studies")
SHIPPED = [path for kind in KINDS for path in sorted(shipped(kind).glob("*.nid"))]


def _keeps_all(text: str) -> str:
    """The text laid out, which says the same with the same comments and is laid out the same again."""
    tidy = layout(text)
    assert parse(Source("tidy", tidy)).root == parse(Source("given", text)).root
    assert random_texts.comments_of(tidy) == random_texts.comments_of(text)
    assert layout(tidy) == tidy
    return tidy


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"], ids=["LF", "CRLF", "CR"])
@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.stem)
def test_shipped_files_with_any_line_ends(path: Path, end: str) -> None:
    text = read_source(path).text.replace("\n", end)
    assert _keeps_all(text) == text


@pytest.mark.parametrize("seed", range(30))
def test_generated_files_mean_the_same(seed: int) -> None:
    rng = Random(seed)
    made, world = random_texts.domain(rng)
    problem, scene = random_texts.problem(world, rng).text, random_texts.scene(rng).text
    domain = load_domain(Source("given", made.text))
    assert load_domain(Source("tidy", _keeps_all(made.text))) == domain
    tidy = load_problem(Source("tidy", _keeps_all(problem)), domain)
    assert tidy == load_problem(Source("given", problem), domain)
    assert load_scene(Source("tidy", _keeps_all(scene))) == load_scene(Source("given", scene))
    study = random_texts.study(rng).text
    assert load_study(Source("tidy", _keeps_all(study))) == load_study(Source("given", study))
