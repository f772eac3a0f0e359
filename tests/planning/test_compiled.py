"""Compiled code is kept where that can be, and compiled all the same where it cannot."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from cleancli.planning.kernels import jit

PACKAGE = Path(__file__).parents[2] / "src" / "cleancli"
SMALL = """
import numpy as np
from cleancli.planning.kernels.state_graph import enter

table = np.full(4, -1)
enter(table, np.array([3, 7], np.uint64), 2)
print(sorted(table.tolist()))
"""
LOADED = f"""{SMALL}
import sys
print("numba.np.arraymath" in sys.modules)
"""
"""Whether numba has imported what it compiles by: this module and all of scipy's linear algebra."""
CALLING = f"""{LOADED}
from cleancli.planning.kernels.jit import has_compiled, njit
print(has_compiled())

@njit()
def calling(table, hashes):
    enter(table, hashes, 2)

table[:] = -1
calling(table, np.array([3, 7], np.uint64))
print(sorted(table.tolist()), has_compiled())
"""


def _installed(folder: Path) -> Path:
    """A copy of what is compiled, as an installation of its own, without what was kept of it."""
    site = folder / "site"
    shutil.copytree(PACKAGE, site / "cleancli", ignore=shutil.ignore_patterns("__pycache__"))
    for kind in ("grammar", "domains", "problems"):
        shutil.copytree(PACKAGE.parents[1] / kind, site / "cleancli" / "shipped" / kind)
    return site


def _run(site: Path, cwd: Path, program: str = SMALL, **environment: str) -> subprocess.CompletedProcess[str]:
    names = ("NUMBA_CACHE_DIR", "HOME", "XDG_CACHE_HOME")
    kept = {name: value for name, value in os.environ.items() if name not in names}
    return subprocess.run(
        [sys.executable, "-c", program],
        env=kept | {"PYTHONPATH": str(site), "PYTHONDONTWRITEBYTECODE": "1"} | environment,
        capture_output=True,
        text=True,
        cwd=cwd,
    )


@pytest.fixture
def read_only(tmp_path: Path) -> Path:
    """An installation in which even root can make no `__pycache__`, because there is a file of that name."""
    site = _installed(tmp_path)
    (site / "cleancli" / "planning" / "kernels" / "__pycache__").write_text("")
    return site


@pytest.mark.parametrize("home", ["/dev/null", "/proc", ""], ids=["no folder", "read-only", "none"])
def test_without_a_place_for_a_cache_the_code_is_compiled_all_the_same(
    home: str, read_only: Path, tmp_path: Path
) -> None:
    (tmp_path / "here").mkdir()
    ended = _run(
        read_only, tmp_path / "here", **({"HOME": home} if home else {}), XDG_CACHE_HOME=home or "/proc"
    )
    assert (ended.returncode, ended.stdout, ended.stderr) == (0, "[-1, -1, 0, 1]\n", "")
    assert not list((tmp_path / "here").iterdir()), "nothing is made in the current folder"


def test_a_cache_is_kept_where_there_is_a_place(tmp_path: Path) -> None:
    site = _installed(tmp_path)
    assert _run(site, tmp_path, HOME=str(tmp_path)).returncode == 0
    kept = list((site / "cleancli" / "planning" / "kernels" / "__pycache__").glob("state_graph.enter*.nbc"))
    assert len(kept) == 1


def test_loading_imports_nothing_that_only_compiling_needs(tmp_path: Path) -> None:
    site = _installed(tmp_path)
    for known in ("True", "False"):
        ended = _run(site, tmp_path, LOADED, HOME=str(tmp_path))
        assert ended.stdout.split("\n") == ["[-1, -1, 0, 1]", known, ""], ended.stderr


def test_what_was_loaded_can_be_called_by_what_is_compiled(tmp_path: Path) -> None:
    site = _installed(tmp_path)
    assert _run(site, tmp_path, HOME=str(tmp_path)).returncode == 0
    ended = _run(site, tmp_path, CALLING, HOME=str(tmp_path))
    expected = ["[-1, -1, 0, 1]", "False", "False", "[-1, -1, 0, 1] True", ""]
    assert ended.stdout.split("\n") == expected, ended.stderr


def test_a_damaged_cache_is_as_good_as_none(tmp_path: Path) -> None:
    site, cache = _installed(tmp_path), tmp_path / "cache"
    assert _run(site, tmp_path, NUMBA_CACHE_DIR=str(cache)).returncode == 0
    for pattern, content in (("*.nbc", b"\x80\x04."), ("*.nbi", b"nothing at all")):
        for path in cache.rglob(pattern):
            path.write_bytes(content)
        ended = _run(site, tmp_path, NUMBA_CACHE_DIR=str(cache))
        assert (ended.returncode, ended.stdout, ended.stderr) == (0, "[-1, -1, 0, 1]\n", ""), pattern


def test_a_full_disk_keeps_nothing_and_hinders_nothing(tmp_path: Path) -> None:
    site, cache = _installed(tmp_path), tmp_path / "cache"
    program = "import resource; resource.setrlimit(resource.RLIMIT_FSIZE, (100, 100))\n" + SMALL
    ended = subprocess.run(
        [sys.executable, "-c", program],
        env=os.environ | {"PYTHONPATH": str(site), "NUMBA_CACHE_DIR": str(cache)},
        capture_output=True,
        text=True,
    )
    assert (ended.returncode, ended.stdout, ended.stderr) == (0, "[-1, -1, 0, 1]\n", "")
    assert not list(cache.rglob("*.nbc"))


def test_a_user_without_a_home_gets_no_folder_of_that_name(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("NUMBA_CACHE_DIR", "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(os, "access", lambda *_: False)
    monkeypatch.setattr(os.path, "expanduser", lambda path: path)
    kept = jit.njit(nogil=True)(_nothing)
    assert type(kept._cache).__name__ == "NullCache"  # type: ignore[attr-defined]


def _nothing() -> None:
    pass
