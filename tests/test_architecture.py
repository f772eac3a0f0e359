"""The import table of ARCHITECTURE.md is what the code does, and heavy libraries stay where it says."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
PACKAGE = ROOT / "src" / "cleancli"
HEAVY = {
    "av",
    "lark",
    "networkx",
    "numba",
    "cv2",
    "scipy",
    "ompl",
    "pybullet",
    "rerun",
    "rosbags",
    "toppra",
    "click",
    "rich",
    "pygls",
    "lsprotocol",
    "matplotlib",
    "gymnasium",
    "dask",
    "distributed",
    "jinja2",
    "pyarrow",
}


@cache
def table() -> dict[str, tuple[str, set[str], set[str]]]:
    """For each name of a row: the row, the packages that it may import, and the libraries."""
    rows = re.findall(
        r"^\| (`[\w.`, ]+`) \|[^|]*\|[^|]*\|[^|]*\|([^|]*)\|([^|]*)\|$",
        (ROOT / "ARCHITECTURE.md").read_text(),
        re.M,
    )
    words = r"`([\w.]+)`"
    return {
        name: (row, set(re.findall(words, allowed)), {w.strip() for w in only.split(",") if w.strip()})
        for row, allowed, only in rows
        for name in re.findall(words, row)
    }


@cache
def imports(path: Path) -> set[str]:
    """Full dotted names of all modules that a file imports, anywhere in it."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            named = {f"{node.module}.{alias.name}" for alias in node.names} & NAMES.keys()
            found |= named or {node.module or ""}
    return found


def name_of(path: Path) -> str:
    """A module's dotted name; a package's for its `__init__`."""
    return ".".join(path.relative_to(PACKAGE.parent).with_suffix("").parts).removesuffix(".__init__")


@cache
def row_of(module: str) -> str:
    """The name in the table that a module of `cleancli` belongs to: the longest."""
    inside = module.removeprefix("cleancli.")
    return max((name for name in table() if f"{inside}.".startswith(f"{name}.")), key=len)


def covers(allowed: str, name: str, row: str) -> bool:
    """Whether a package that a row names stands for another row's: its parts with it, unless it is that of
    the row itself."""
    own = allowed.split(".")[0] == row.strip("`").split(".")[0]
    return name == allowed if own else f"{name}.".startswith(f"{allowed}.")


MODULES = sorted(p for p in PACKAGE.rglob("*.py") if p != PACKAGE / "__init__.py")
NAMES = {name_of(path): path for path in MODULES}


def test_every_row_is_of_something_and_every_package_has_one() -> None:
    packages = {name_of(path.parent).removeprefix("cleancli.") for path in MODULES} - {"cleancli"}
    assert set(table()) <= packages | {name.removeprefix("cleancli.") for name in NAMES}
    assert packages <= set(table())


@pytest.mark.parametrize("path", MODULES, ids=lambda p: str(p.relative_to(PACKAGE)))
def test_imports_follow_the_table(path: Path) -> None:
    rows = table()
    row, allowed, libraries = rows[row_of(name_of(path))]
    wanted = {row_of(name) for name in imports(path) if name.startswith("cleancli.")}
    others = {name for name in wanted if rows[name][0] != row}
    beyond = {name for name in others if not any(covers(each, name, row) for each in allowed)}
    assert not beyond, "imports a package that its row does not name"
    heavy = {name.split(".")[0] for name in imports(path)} & HEAVY
    assert heavy <= libraries, "imports a library that belongs to another package"


def test_entry_points_are_where_the_table_says() -> None:
    rows = re.findall(r"^\| (`[\w.`, ]+`) \|[^|]*\|([^|]*)\|", (ROOT / "ARCHITECTURE.md").read_text(), re.M)
    assert len(rows) > 30
    for row, points in rows:
        within = (path for name, path in NAMES.items() if table()[row_of(name)][0] == row)
        defined = {
            word for path in within for word in re.findall(r"^(?:class |def )?(\w+)", path.read_text(), re.M)
        }
        assert set(re.findall(r"`(\w+)`", points)) <= defined, row


def test_each_row_needs_only_rows_above_it() -> None:
    order = list(dict.fromkeys(row for row, _, _ in table().values()))
    for row, allowed, _ in table().values():
        for name, (other, _, _) in table().items():
            if other != row and any(covers(each, name, row) for each in allowed):
                assert order.index(other) < order.index(row), f"{row} needs {other}"


def test_no_row_names_what_nothing_of_it_imports() -> None:
    used: dict[str, set[str]] = {}
    for path in MODULES:
        needed = {row_of(name) for name in imports(path) if name.startswith("cleancli.")}
        used.setdefault(table()[row_of(name_of(path))][0], set()).update(needed)
    idle = {
        (row, one)
        for row, allowed, _ in table().values()
        for one in allowed
        if not any(covers(one, each, row) for each in used[row])
    }
    assert not idle


def test_no_import_cycle_between_modules() -> None:
    names = {path: ".".join(path.relative_to(PACKAGE.parent).with_suffix("").parts) for path in MODULES}
    known = set(names.values())
    graph = {names[path]: imports(path) & known for path in MODULES}
    done: set[str] = set()

    def visit(module: str, trail: tuple[str, ...]) -> None:
        assert module not in trail, " -> ".join((*trail, module))
        if module not in done:
            for imported in sorted(graph[module]):
                visit(imported, (*trail, module))
            done.add(module)

    for module in sorted(graph):
        visit(module, ())


@pytest.mark.parametrize(
    ("code", "absent"),
    [
        ("import cleancli.cli.main", HEAVY - {"click"} | {"numpy"}),
        ("import cleancli.cli.commands.check", HEAVY - {"click", "lark"} | {"numpy"}),
        ("import cleancli.cli.commands.learn", {"numba", "cv2", "pybullet", "scipy"}),
        ("import cleancli.cli.commands.plan", {"numba", "scipy", "matplotlib", "cv2", "av", "pybullet"}),
        ("import cleancli.cli.commands.lsp", HEAVY - {"click"} | {"numpy"}),
        ("import cleancli.editor.completion", HEAVY - {"lark"} | {"numpy"}),
        ("import cleancli.planning.registry", {"numba", "cv2", "pybullet"}),
        ("import cleancli.world.robot", {"pybullet", "cv2", "numba"}),
        ("import cleancli.world.table", {"pybullet", "ompl", "toppra", "scipy", "matplotlib"}),
    ],
)
def test_heavy_libraries_stay_out(code: str, absent: set[str]) -> None:
    script = f"import sys; {code}; print(*(set({sorted(absent)!r}) & sys.modules.keys()))"
    result = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert result.stdout.split() == []


@pytest.mark.parametrize(
    "words",
    [
        "check cleaning three_areas",
        "compile cleaning three_areas",
        "plan cleaning three_areas",
        "plan cleaning three_areas --planner exact --option arithmetic=rational",
    ],
)
def test_commands_load_no_heavy_library_that_they_do_not_use(words: str) -> None:
    """Here nothing is drawn in a terminal, no scene is looked at, and no compiled loop is run."""
    absent = sorted({"rich", "msgspec", "numba", "numpy.ma", "scipy", "matplotlib", "cv2", "pybullet"})
    script = (
        "import sys; from cleancli.cli.main import run;"
        f" code = run({words.split()!r});"
        f" print(code, *(set({absent!r}) & sys.modules.keys()), file=sys.stderr)"
    )
    result = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert result.stderr.split() == ["0"]


def test_what_tests_share_is_in_their_support() -> None:
    """What lies beside them has no name that others could import it by (docs/tests.md)."""
    tests = ROOT / "tests"
    modules = {path.relative_to(tests) for path in tests.rglob("*.py") if not path.name.startswith("test_")}
    assert {path for path in modules if path.parts[0] != "support"} == {Path("conftest.py")}


def test_only_reports_ask_where_the_lentils_truly_are() -> None:
    askers = {
        str(path.relative_to(PACKAGE))
        for path in MODULES
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Attribute) and node.attr == "truth"
    }
    assert askers == {
        "api/run_result.py",
        "api/runs.py",
        "cli/commands/scene.py",
        "environment/clean_table.py",
        "execution/session.py",
        "execution/trials.py",
        "experiment/episode.py",
        "report/account.py",  # of run.json, after the run
    }
