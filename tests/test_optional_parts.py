"""Parts that may be missing are told by their name, and nothing else that fails is taken for one of them."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Callable, Sequence
from importlib.machinery import ModuleSpec
from pathlib import Path

import pytest

from cleancli.cli.commands import experiment, lsp
from cleancli.cli.exit_codes import MissingPart
from cleancli.cli.views.plan_picture import check_picture
from cleancli.perception.bag_file import MissingBags, find_rosbags
from cleancli.perception.rerun_file import MissingRerun, find_rerun


def of_experiments(module: str) -> object:
    with experiment._optional_parts():
        return importlib.import_module(module)


PARTS: dict[str, tuple[str, Callable[[], object], type[Exception]]] = {
    "distributed": ("distributed", lambda: of_experiments("distributed"), MissingPart),
    "pyarrow": ("pyarrow", lambda: of_experiments("pyarrow"), MissingPart),
    "matplotlib": ("matplotlib.figure", lambda: check_picture(Path("plan.png")), MissingPart),
    "pygls": ("cleancli.editor.server", lsp._server, MissingPart),
    "rerun": ("rerun", find_rerun, MissingRerun),
    "rosbags": ("rosbags", find_rosbags, MissingBags),
}


class Fails:
    """An importer of one module, which finds that another one is missing."""

    def __init__(self, module: str, missing: str | None) -> None:
        self._module, self._missing = module, missing

    def find_spec(self, name: str, path: Sequence[str] | None, target: object = None) -> ModuleSpec | None:
        if name == self._module:
            raise ModuleNotFoundError(f"No module named {self._missing!r}", name=self._missing)
        return None


@pytest.mark.parametrize("part", PARTS)
@pytest.mark.parametrize("name", ["{}", "{}.inner", "another", None])
def test_a_part_is_missing_where_its_own_module_is(
    part: str, name: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    module, load, missing = PARTS[part]
    monkeypatch.delitem(sys.modules, module, raising=False)
    failing = Fails(module, None if name is None else name.format(part))
    monkeypatch.setattr(sys, "meta_path", [failing, *sys.meta_path])
    is_part = name is not None and name.startswith("{}")
    with pytest.raises(missing if is_part else ModuleNotFoundError) as told:
        load()
    assert ("pip install" in str(told.value)) == is_part
