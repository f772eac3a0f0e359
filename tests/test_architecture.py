"""The import table of ARCHITECTURE.md is what the code does, and heavy libraries stay where it says."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
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
    "toppra",
    "click",
    "rich",
    "pygls",
    "lsprotocol",
    "matplotlib",
    "gymnasium",
    "jinja2",
}


def table() -> dict[str, tuple[set[str], set[str]]]:
    """Package -> (packages it may import, libraries it is the only place for)."""
    rows = re.findall(
        r"^\| `(\w+)` \|[^|]*\|([^|]*)\|([^|]*)\|$", (ROOT / "ARCHITECTURE.md").read_text(), re.M
    )
    return {
        name: (set(re.findall(r"`(\w+)`", allowed)), {w.strip() for w in only.split(",") if w.strip()})
        for name, allowed, only in rows
    }


def imports(path: Path) -> set[str]:
    """Full dotted names of all modules that a file imports, anywhere in it."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            found.add(node.module or "")
    return found


def package_of(path: Path) -> str:
    return path.relative_to(PACKAGE).parts[0].removesuffix(".py")


MODULES = sorted(p for p in PACKAGE.rglob("*.py") if p != PACKAGE / "__init__.py")


def test_every_package_has_a_row() -> None:
    assert {package_of(path) for path in MODULES} == set(table())


@pytest.mark.parametrize("path", MODULES, ids=lambda p: str(p.relative_to(PACKAGE)))
def test_imports_follow_the_table(path: Path) -> None:
    package = package_of(path)
    rows = table()
    own = {name.split(".")[1] for name in imports(path) if name.startswith("cleancli.")} - {package}
    assert own <= rows[package][0], "imports a package that its row does not name"
    heavy = {name.split(".")[0] for name in imports(path)} & HEAVY
    assert heavy <= rows[package][1], "imports a library that belongs to another package"


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
        ("import cleancli.cli.commands.learn", {"numba", "cv2", "pybullet", "numpy"}),
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


def test_only_reports_ask_where_the_lentils_truly_are() -> None:
    askers = {
        str(path.relative_to(PACKAGE))
        for path in MODULES
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Attribute) and node.attr == "truth"
    }
    assert askers == {
        "cli/commands/execute.py",
        "cli/commands/scene.py",
        "environment/clean_table.py",
        "execution/session.py",
        "execution/trials.py",
        "report/account.py",  # of run.json, after the run
    }
