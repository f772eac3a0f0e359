"""How large the parts of the code are, and how deep imports go: `python benchmarks/structure.py [ROOT]`.

For each package below `src/cleancli`: modules, lines, the longest module, how many modules its largest folder
has, and floors. A module of the package, or a folder in it, that imports nothing else of the package stands
on the first, any other one above the highest that it imports. Then code lines of functions (without their
docstrings): median, 95th percentile and longest, and the longest modules. ROOT is a checkout, by default this
one, so that an earlier commit can be compared. Takes a second.
"""

from __future__ import annotations

import argparse
import ast
import statistics
from collections.abc import Iterator
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
SHOWN = 5


def modules(root: Path) -> dict[str, ast.Module]:
    """The modules of the checkout by their dotted names."""
    sources = root / "src"
    paths = sorted((sources / "cleancli").rglob("*.py"))
    names = (".".join(path.relative_to(sources).with_suffix("").parts) for path in paths)
    return {
        name: ast.parse(path.read_text(encoding="utf-8")) for name, path in zip(names, paths, strict=True)
    }


def imported(tree: ast.Module, known: dict[str, ast.Module]) -> set[str]:
    found = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.module:
            named = {f"{node.module}.{alias.name}" for alias in node.names} & known.keys()
            found |= named or ({node.module} & known.keys())
    return found


def floors(names: list[str], known: dict[str, ast.Module]) -> int:
    """How many floors the modules of a package stand on, those in one of its folders together."""

    def part(name: str) -> str:
        return ".".join(name.split(".")[:3])

    needs: dict[str, set[str]] = {part(name): set() for name in names}
    for name in names:
        needs[part(name)] |= {part(other) for other in imported(known[name], known) & set(names)} - {
            part(name)
        }

    @cache
    def floor(one: str) -> int:
        return 1 + max(map(floor, needs[one]), default=0)

    return max(map(floor, needs))


def functions(tree: ast.Module) -> Iterator[tuple[int, str]]:
    """Code lines of each function, and its name: not those of its docstring."""
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            first = node.body[0]
            told = ast.get_docstring(node) is not None
            docstring = (first.end_lineno or 0) - first.lineno + 1 if told else 0
            yield (node.end_lineno or 0) - node.lineno + 1 - docstring, node.name


def length(tree: ast.Module) -> int:
    return max((getattr(node, "end_lineno", 0) or 0 for node in tree.body), default=0)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("root", nargs="?", type=Path, default=ROOT, metavar="ROOT")
    known = modules(parser.parse_args().root)
    packages: dict[str, list[str]] = {}
    for name, tree in known.items():
        if tree.body and not name.endswith("__init__"):
            packages.setdefault(name.split(".")[1], []).append(name)
    print("package        modules  floors  lines  longest  largest folder")
    for package, names in packages.items():
        lengths = [length(known[name]) for name in names]
        folders = [name.rpartition(".")[0] for name in names]
        largest = max(folders.count(folder) for folder in folders)
        numbers = f"{len(names):7} {floors(names, known):7} {sum(lengths):6} {max(lengths):8} {largest:15}"
        print(f"{package:14} {numbers}")
    found = sorted(pair for tree in known.values() for pair in functions(tree))
    sizes = [size for size, _ in found]
    most = sizes[(len(sizes) * 19 - 1) // 20]
    print(f"\n{len(known)} modules, {sum(map(length, known.values()))} lines")
    middle = statistics.median(sizes)
    print(f"{len(sizes)} functions: median {middle:g} lines, 95 % {most:g}, longest {sizes[-1]}")
    print("longest functions:", ", ".join(f"{name} {size}" for size, name in found[: -SHOWN - 1 : -1]))
    longest = sorted(((length(tree), name) for name, tree in known.items()), reverse=True)[:SHOWN]
    print("longest modules:", ", ".join(f"{name.removeprefix('cleancli.')} {size}" for size, name in longest))


if __name__ == "__main__":
    main()
