"""Runs of tests in processes that mutation.py forks: in copies of the checkout, never in the checkout itself.

The parent has the heavy libraries loaded, and none of cleancli, so a run starts at once and takes the modules
of its copy.
"""

from __future__ import annotations

import ast
import compileall
import contextlib
import hashlib
import importlib
import importlib.util
import json
import os
import py_compile
import resource
import shutil
import signal
import subprocess
import sys
import time
import traceback
from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mutants import Change

ROOT = Path(__file__).resolve().parents[1]
LIBRARIES = (
    "numpy", "numba", "scipy.stats", "scipy.optimize", "scipy.spatial", "scipy.ndimage", "cv2", "lark",
    "click", "rich.console", "rich.table", "rich.live", "rich.progress", "msgspec", "networkx", "jinja2",
    "hypothesis", "pytest", "av", "toppra", "pybullet", "pygls", "lsprotocol.types", "gymnasium",
    "importlib.metadata",
)  # fmt: skip
COPIED = (
    "src", "tests", "benchmarks", "docs", "domains", "editors", "grammar", "problems", "README.md",
    "ARCHITECTURE.md", "CHANGELOG.md", "pyproject.toml",
)  # fmt: skip
# These look at the text of the sources, or run other tests, and say nothing of what the code does.
LEFT_OUT = frozenset(
    {
        "tests/test_style.py",
        "tests/test_architecture.py",
        "tests/test_package.py",
        "tests/test_benchmarks.py",
        "tests/test_mutation.py",
    }
)
_WALL_SECONDS = 900.0
TYPES = "tests/test_style.py::types"
"""What the type checker is called where it notices a change: a test of the suite runs it."""


@dataclass(frozen=True, slots=True)
class Ended:
    """How a run of tests ended: pytest's exit code, or minus the signal that ended it."""

    code: int
    said: str
    seconds: float


def load_libraries() -> None:
    """Import what tests need and what takes long; what is not installed is left to the tests."""
    for name in LIBRARIES:
        with contextlib.suppress(ImportError):
            importlib.import_module(name)


def make_copy(target: Path) -> None:
    """A copy of the checkout, as it lies there, with its modules compiled."""
    shutil.rmtree(target, ignore_errors=True)
    target.mkdir(parents=True)
    ignored = shutil.ignore_patterns("__pycache__", "*.egg-info")
    for name in COPIED:
        source = ROOT / name
        if source.is_dir():
            shutil.copytree(source, target / name, ignore=ignored)
        else:
            shutil.copy2(source, target / name)


def compile_modules(copy: Path) -> None:
    """Runs write no byte code, lest that of a change is found by the next one."""
    compileall.compile_dir(copy / "src", quiet=1)


@contextlib.contextmanager
def applied(copy: Path, kernels: Path, change: Change) -> Iterator[Path]:
    """A change made in a copy, for a while; where machine code is kept that knows of it.

    Machine code is kept by the text of its own module alone, so what a change may be part of is left out.
    """
    path = copy / "src" / "cleancli" / change.module
    original = path.read_text(encoding="utf-8")
    code = Path(importlib.util.cache_from_source(str(path)))
    code.unlink(missing_ok=True)
    path.write_text(change.text, encoding="utf-8")
    own = copy / ".kernels"
    try:
        if change.compiled:
            shutil.copytree(kernels, own, ignore=shutil.ignore_patterns(*_stale(change.module)))
            yield own
        else:
            _KEPT_BY[str(path)] = hashlib.sha256(original.encode()).digest()
            yield kernels
    finally:
        _KEPT_BY.pop(str(path), None)
        shutil.rmtree(own, ignore_errors=True)
        path.write_text(original, encoding="utf-8")
        py_compile.compile(str(path))


def _stale(module: str) -> list[str]:
    """Names of files of machine code that a change of a module may have a part in."""
    users = {module, *importers().get(module, ())}
    return [f"{Path(user).stem}.*" for user in users]


_KEPT_BY: dict[str, bytes] = {}


def keep_kernels_by_their_own_text() -> None:
    """A change outside of compiled functions leaves their machine code as it is: let numba take it."""
    with contextlib.suppress(ImportError):
        caching: Any = importlib.import_module("numba.core.caching")
        by_text = caching._hash_source_file

        def kept(path: str, *rest: object) -> bytes:
            return _KEPT_BY.get(str(path)) or bytes(by_text(path, *rest))

        caching._hash_source_file = kept


def run(
    copy: Path, files: list[str], job: Mapping[str, object], kernels: Path, limit: float, work: Path
) -> Ended:
    """Run pytest on some test files of a copy, in a process of its own group; `limit` is of the processor's
    seconds, `work` a folder for what this run writes."""
    work.mkdir(parents=True, exist_ok=True)
    (work / "job.json").write_text(json.dumps(job), encoding="utf-8")
    (work / "output").unlink(missing_ok=True)
    started = time.perf_counter()
    process = os.fork()
    if process == 0:
        _child(copy, files, kernels, limit, work)
    code = _wait(process)
    said = (work / "output").read_text(encoding="utf-8", errors="replace")
    return Ended(code, said, time.perf_counter() - started)


def _child(copy: Path, files: list[str], kernels: Path, limit: float, work: Path) -> None:
    code = 70
    try:
        os.setpgid(0, 0)
        output = os.open(work / "output", os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        nothing = os.open(os.devnull, os.O_RDONLY)
        for number, file in enumerate((nothing, output, output)):
            os.dup2(file, number)
        os.chdir(copy)
        benchmarks = str(copy / "benchmarks")
        sys.dont_write_bytecode = True
        os.environ.update(
            PYTHONDONTWRITEBYTECODE="1",
            PYTHONPATH=str(copy / "src"),
            MUTATION_JOB=str(work / "job.json"),
            MUTATION_JOB_PROCESS=str(os.getpid()),
            MUTATION_DUMPS=str(work),
            NUMBA_CACHE_DIR=str(kernels),
        )
        # An environment may lie within the checkout: what is installed there stays.
        own = tuple(str(ROOT / name) for name in ("src", "benchmarks", "tests"))
        others = (path for path in sys.path if path != str(ROOT) and not path.startswith(own))
        sys.path[:] = [str(copy / "src"), benchmarks, *others]
        numba = sys.modules.get("numba")
        if numba is not None:
            numba.config.CACHE_DIR = str(kernels)
        resource.setrlimit(
            resource.RLIMIT_CPU, (int(limit + time.process_time()) + 1, resource.RLIM_INFINITY)
        )
        code = _pytest(files)
    except BaseException:
        traceback.print_exc()
        sys.stderr.flush()
    finally:
        os._exit(code)


def _pytest(files: list[str]) -> int:
    import pytest

    options = ["-o", "addopts=", "-x", "-q", "--no-header", "-p", "no:cacheprovider", "--assert=plain"]
    job = json.loads(Path(os.environ["MUTATION_JOB"]).read_text(encoding="utf-8"))
    if "order" not in job:
        options.remove("-x")
    code = int(pytest.main([*options, "-p", "mutation_plugin", *files]))
    sys.stdout.flush()
    sys.stderr.flush()
    return code


def _wait(process: int) -> int:
    """The exit code of a process, or minus its signal; its whole group is ended with it."""
    end = time.perf_counter() + _WALL_SECONDS
    pause = 0.01
    while True:
        done, status = os.waitpid(process, os.WNOHANG)
        if done:
            break
        if time.perf_counter() > end:
            os.killpg(process, signal.SIGKILL)
            status = os.waitpid(process, 0)[1]
            break
        time.sleep(pause)
        pause = min(0.1, pause * 1.5)
    with contextlib.suppress(ProcessLookupError, PermissionError):
        os.killpg(process, signal.SIGKILL)
    return os.waitstatus_to_exitcode(status)


def imported(path: Path) -> set[str]:
    """The modules of cleancli that a file imports, itself or by the tests' support, as paths below it."""
    found: set[str] = set()
    pending, seen = [path], {path}
    while pending:
        for name in _imported_names(pending.pop()):
            package, *parts = name.split(".")
            if package == "cleancli":
                found.add("/".join(parts) + ".py")
            shared = ROOT / "tests" / "support" / ("/".join(parts) + ".py")
            if package == "support" and shared.is_file() and shared not in seen:
                seen.add(shared)
                pending.append(shared)
    return found


def _imported_names(path: Path) -> Iterator[str]:
    """Dotted names that a file imports something of, and of what it may be a module itself."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module is not None:
            yield from (node.module, *(f"{node.module}.{alias.name}" for alias in node.names))


def importers() -> dict[str, set[str]]:
    """For each module, those that import it, and those that import them."""
    sources = ROOT / "src" / "cleancli"
    direct: dict[str, set[str]] = defaultdict(set)
    for path in sources.rglob("*.py"):
        for module in imported(path):
            direct[module].add(path.relative_to(sources).as_posix())
    found = {}
    for module in list(direct):
        pending, seen = [module], set()
        while pending:
            for user in direct.get(pending.pop(), ()):
                if user not in seen:
                    seen.add(user)
                    pending.append(user)
        found[module] = seen
    return found


def well_typed(copy: Path) -> bool:
    """Whether the type checker finds no mistake in the sources of a copy; what it knows of unchanged modules
    is kept in the copy."""
    words = [sys.executable, "-m", "mypy", "src", "--cache-dir", str(copy / ".types")]
    return subprocess.run(words, cwd=copy, capture_output=True, timeout=_WALL_SECONDS).returncode == 0
