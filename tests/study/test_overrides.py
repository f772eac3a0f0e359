"""A scene that a study varies is the scene with that written in it."""

from __future__ import annotations

import pytest

from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.find import find
from cleancli.language.load import read_source
from cleancli.scene.check import load_scene
from cleancli.study.check import load_study
from cleancli.study.overrides import varied

SCENE = read_source(find("two_groups", "problems"))


def with_settings(body: str) -> tuple[Source, dict[str, object]]:
    source = Source("s.nid", f"study s {{ scene = two_groups {body} }}")
    study = load_study(source)
    written = {a: next(iter(v.values())) for a, v in study.written.items() if "." in a}
    return source, dict(written)


@pytest.mark.parametrize(
    ("body", "old", "new"),
    [
        ("rag { width = 8 cm }", "width = 12 cm }", "width = 8 cm }"),
        ("rag { grasp = folded }", "grasp = wide", "grasp = folded"),
        ("robot { drive = wam }", "drive = gantry", "drive = wam"),
        ("symbols { link = 35 mm near = 10 cm }", "link = 50 mm", "link = 35 mm"),
        ("light { ambient = 0.5 }", "camera ", "light { ambient = 0.5 } camera "),
        ("camera { at = (0 cm, 3 cm) height = 1.2 m }", "height = 0.9 m", "height = 1.2 m at = (0 cm, 3 cm)"),
    ],
)
def test_it_is_as_if_it_were_written_there(body: str, old: str, new: str) -> None:
    study, written = with_settings(body)
    scene, text = varied(SCENE, written, study)  # type: ignore[arg-type]
    by_hand = SCENE.text.replace(old, new).replace(
        "near = 20 cm", "near = 10 cm" if "near" in body else "near = 20 cm"
    )
    assert scene == load_scene(Source("by hand", by_hand))
    assert load_scene(text) == scene


def test_without_any_the_text_stays_as_it_is() -> None:
    study, _ = with_settings("")
    assert varied(SCENE, {}, study)[1] is SCENE


def test_what_does_not_fit_is_told_where_the_study_says_it() -> None:
    study, written = with_settings("rag { width = 40 cm }")
    with pytest.raises(Refused) as refused:
        varied(SCENE, written, study)  # type: ignore[arg-type]
    (found,) = refused.value.diagnostics
    assert found.code == "E509"
    assert found.span is not None
    assert study.text[found.span.start : found.span.end] == "40 cm"
