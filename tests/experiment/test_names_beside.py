"""A name that is almost that of a file beside the study is told that one, before all shipped ones."""

from __future__ import annotations

from pathlib import Path

import pytest

from cleancli.experiment.series import open_studies
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.refused import Refused


@pytest.mark.parametrize(
    ("body", "meant"), [("scene = nigth", "night"), ("scene = three_areas  domain = wacht", "watch")]
)
def test_files_beside_the_study_are_suggested(tmp_path: Path, body: str, meant: str) -> None:
    for name in ("night", "watch"):
        (tmp_path / f"{name}.nid").touch()
    with pytest.raises(Refused) as error:
        open_studies(Source(str(tmp_path / "s.nid"), f"study s {{ {body} }}"))
    (found,) = error.value.diagnostics
    assert found.code == "E001"
    assert found.help.startswith(f"did you mean `{meant}`? shipped: ")
