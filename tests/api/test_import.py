"""`import cleancli` loads nothing but itself, and says what there is."""

from __future__ import annotations

import subprocess
import sys
from types import ModuleType

import pytest

import cleancli
from cleancli.planning import kernels


def python(code: str) -> str:
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout


def test_importing_loads_no_other_module() -> None:
    code = "import sys; before = set(sys.modules); import cleancli; print(*set(sys.modules) - before)"
    assert python(code).split() == ["cleancli"]


def test_importing_costs_less_than_starting_python() -> None:
    """In CPU seconds of one process; the least of several, for others use the machine too."""
    code = (
        "import time; bare = time.process_time(); import cleancli; print((time.process_time() - bare) / bare)"
    )
    assert min(float(python(code)) for _ in range(5)) < 1


def test_each_name_loads_what_it_needs_alone() -> None:
    code = "import sys, cleancli; cleancli.{}; print(*{} & set(sys.modules))"
    never = {"pybullet", "click", "rich", "matplotlib"}
    heavy = {name: never | {"numba", "cv2"} for name in ("learn", "plan", "simulate")}
    for name, absent in {**heavy, "execute": never, "Refused": {*never, "lark", "numpy"}}.items():
        assert python(code.format(name, absent)).split() == [], name


@pytest.mark.parametrize("module", [cleancli, kernels], ids=lambda module: module.__name__)
def test_whether_a_module_that_loads_late_has_a_name_can_be_asked(module: ModuleType) -> None:
    assert not hasattr(module, "no_such_name")
    assert getattr(module, "no_such_name", 7) == 7


def test_all_names_are_there() -> None:
    assert set(cleancli.__all__) <= set(dir(cleancli))
    for name in cleancli.__all__:
        assert getattr(cleancli, name).__doc__
    with pytest.raises(AttributeError, match="has no attribute 'clean'"):
        cleancli.clean  # noqa: B018
