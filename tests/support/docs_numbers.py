"""Where every number of the documents comes from: `python tests/support/docs_numbers.py [PAGE ...]`.

Prints each number of docs/ with the command that makes it or the file that sets it, and those that have
neither at the end (exit code 1). The rule is in docs/decisions/0010-numbers-name-their-source.md:

- A *passage* is a paragraph, an item of a list, or a table. What a passage names in backticks counts for it:
  a command (`python benchmarks/...`, `cleancli ...`, a file of tests), or a file of the sources.
- A table or an item also takes what the passages before it name, up to and with the paragraph that introduces
  them; a table takes what the passage after it names as well.
- What "Numbers of this section:" or "Numbers of this page:" names counts for all of it.
- A command makes any number. A file sets only the numbers that stand in it, whatever their unit.

Left out: code, headings, targets of links, numbers of sections, equations, figures and items, codes of
messages, versions, years, exit codes, seeds, examples, and a bare 0, 1 or 2.
"""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import takewhile
from math import isclose, pi
from pathlib import Path

ROOT = Path(__file__).parents[2]
PAGES = tuple(sorted((ROOT / "docs").rglob("*.md")))


NUMBER = re.compile(r"(?<![\w.,^-])[-−]?\d+(?:\^\d+)?(?:,\d{3})*(?:\.\d+)?(?:e-?\d+)?(?![\w])")
NO_FIGURE = re.compile(
    r"""
    `[^`]*` | \]\([^)]*\) | ^\s*\d+\.\s              # code, targets of links, the number of an item
    | §\s?[\d.]+(?:\s(?:to|and)\s§?[\d.]+)?          # sections of the paper
    | \beqs?\.\s\d+ | \bFig\.\s\d+ | \b[EWD]\d{3,4}\b | [dD]ecision\s\d+
    | \b(?:Python|[Vv]ersion|Emacs|bash|pybullet|PDDL)\s\(?\d[\d.]*\w*(?:\s(?:to|and|or)\s\d[\d.]*)*
    | (?:\(|,\s|[a-z]\s)(?:19|20)\d\d\b(?=[),:;])    # the year of a publication
    | \bexit\scodes?\s\d+ | \bstep\s\d+ | \b\d+\sbits\b | \bseeds?\s\d+(?:(?:\sto|,|\sand)\s\d+)*
    | (?<![\w.,-])-?[012](?![\w]|[.,]\d|-|\s?(?:%|mm|cm|m\b|ms|s\b|g\b|rad|degrees|°|MB|kB))
    | γ\^\S+
    """,
    re.VERBOSE | re.MULTILINE,
)
NAMED = re.compile(r"`([^`]+)`")
COMMAND = re.compile(
    r"(?:python (?:benchmarks|tests)/\w+\.py|cleancli [a-z]\w*|pytest |tests/[\w/]+(?:\.py)?$)"
)
FENCED_COMMAND = re.compile(r"^(?:python benchmarks/\w+\.py|cleancli [a-z]\w*|pytest ).*$", re.MULTILINE)
WHOLE = re.compile(r"^Numbers of this (section|page):")
UNITS = (1.0, 1e3, 1e-2, 1e-3, 1e-4, 1e-6, 60.0, pi / 180, 1024.0, 1024.0**2, 1024.0**3)
"""What a number in some unit is multiplied by in the code: km, %, cm, mm, cm², min, degrees, kB, MB, GB."""


@dataclass(frozen=True, slots=True)
class Passage:
    """Some lines of a page: where they begin, in which section, and what they are: `text`, `item`, `table`,
    `code` or `heading`."""

    page: str
    line: int
    section: int
    kind: str
    text: str

    def names(self) -> tuple[str, ...]:
        """Commands and files that stand here, in backticks or as a block of code."""
        if self.kind == "code":
            return tuple(FENCED_COMMAND.findall(self.text))
        return tuple(" ".join(name.split()) for name in NAMED.findall(self.text))

    def numbers(self) -> tuple[str, ...]:
        """Those that somebody measured, counted or chose."""
        if self.kind in ("code", "heading") or WHOLE.match(self.text) or self.text.startswith("- Example:"):
            return ()
        return tuple(NUMBER.findall(NO_FIGURE.sub(" ", self.text)))


@dataclass(frozen=True, slots=True)
class Number:
    """A number of a page, and the command or file it comes from; empty where there is none."""

    page: str
    line: int
    written: str
    source: str


def called(page: Path) -> str:
    """A page as its path from the root, without the ending: pages of two folders may have one name."""
    return str(page.relative_to(ROOT).with_suffix(""))


def passages(page: str, text: str) -> Iterator[Passage]:
    """The page in parts."""
    block, section = Passage(page, 0, 0, "", ""), 0
    for number, line in enumerate(text.splitlines(), 1):
        kind = _kind(line, block)
        if kind != block.kind or kind in ("heading",) or _begins_item(line, block):
            if block.kind:
                yield block
            section += kind == "heading"
            block = Passage(page, number, section, kind, line)
        else:
            block = replace(block, text=f"{block.text}\n{line}")
    if block.kind:
        yield block


def _kind(line: str, block: Passage) -> str:
    """Of the passage that a line belongs to; empty between passages."""
    fences = block.text.count("```")
    if block.kind == "code" and fences % 2 == 1:
        return "code"
    if line.startswith("```"):
        return "code"
    if line.startswith("#"):
        return "heading"
    if not line.strip():
        return ""
    if line.startswith("    ") and block.kind in ("", "code"):
        return "code"
    if line.startswith("|"):
        return "table"
    if re.match(r"(-|\d+\.)\s", line) or (block.kind == "item" and line.startswith(" ")):
        return "item"
    return "text"


def _begins_item(line: str, block: Passage) -> bool:
    return block.kind == "item" and not line.startswith(" ")


def sourced(page: str, text: str) -> Iterator[Number]:
    """Each number of a page with its source."""
    parts = list(passages(page, text))
    of_page = [n for part in parts if _covers(part, "page") for n in part.names()]
    for index, part in enumerate(parts):
        if not part.numbers():
            continue
        near = [n for other in _near(parts, index) for n in other.names()]
        section = [other for other in parts if other.section == part.section and _covers(other, "section")]
        names = [*near, *(n for other in section for n in other.names()), *of_page]
        for written in part.numbers():
            yield Number(page, part.line, written, _source(written, names))


def _covers(part: Passage, what: str) -> bool:
    found = WHOLE.match(part.text)
    return found is not None and found[1] == what


def _near(parts: Sequence[Passage], index: int) -> list[Passage]:
    """The passage itself, those whose sources are its own as well, and for a table the one after it."""
    part = parts[index]
    if part.kind == "text":
        before = parts[index - 1 : index]
        return [part, *(other for other in before if other.kind == "code" and other.section == part.section)]
    earlier = [other for other in reversed(parts[:index]) if other.section == part.section]
    same = list(takewhile(lambda other: other.kind != "text", earlier))
    after = parts[index + 1 : index + 2] if part.kind == "table" else []
    intro = earlier[len(same) : len(same) + 1]
    return [part, *(other for other in same if other.kind == "code"), *intro, *after]


def _source(written: str, names: Sequence[str]) -> str:
    """The first command, or else the first file that sets the number."""
    commands = (name for name in names if COMMAND.match(name))
    files = (name for name in names if _file(name) is not None and _sets(name, written))
    return next(files, None) or next(commands, "")


def _file(name: str) -> Path | None:
    """The file of the sources that is meant, from the root or from the package."""
    if not re.fullmatch(r"[\w/.]+\.(?:py|nid|lark|toml)", name):
        return None
    places = (ROOT / name, ROOT / "src" / "cleancli" / name)
    return next((place for place in places if place.is_file()), None)


def _sets(name: str, written: str) -> bool:
    base, _, exponent = written.replace(",", "").replace("−", "-").partition("^")
    value = abs(float(base)) ** int(exponent or 1)
    path = _file(name)
    assert path is not None
    return any(isclose(value * unit, found, rel_tol=1e-6) for unit in UNITS for found in _numbers_in(path))


@cache
def _numbers_in(path: Path) -> frozenset[float]:
    """Numbers of a file: of Python, its literals and those multiplied or shifted; of others, all."""
    text = path.read_text(encoding="utf-8")
    if path.suffix != ".py":
        return frozenset(float(n.replace("_", "")) for n in re.findall(r"\d+(?:\.\d+)?", text))
    found = set()
    for node in ast.walk(ast.parse(text)):
        value = _value(node)
        if value is not None:
            found.add(abs(value))
    return frozenset(found)


def _value(node: ast.AST) -> float | None:
    """What a literal or a calculation of literals comes to."""
    match node:
        case ast.Constant(value=int() | float() as value) if not isinstance(value, bool):
            return float(value)
        case ast.BinOp(left, operator, right):
            one, other = _value(left), _value(right)
            if one is None or other is None:
                return None
            match operator:
                case ast.Mult():
                    return one * other
                case ast.Div() if other:
                    return one / other
                case ast.LShift():
                    return one * 2**other
                case ast.Pow() if abs(other) < 64:
                    return float(one**other)
    return None


def named_commands(text: str) -> Iterator[str]:
    """Commands that passages of a page name as sources."""
    for part in passages("", text):
        yield from (name for name in part.names() if COMMAND.match(name))


def main(pages: Sequence[Path]) -> int:
    """Print the list; 1 where a number has no source."""
    numbers = [
        number
        for page in pages
        for number in sourced(str(page.relative_to(ROOT)), page.read_text(encoding="utf-8"))
    ]
    for number in numbers:
        if number.source:
            print(f"{number.page}:{number.line}: {number.written}  {number.source}")
    without = [number for number in numbers if not number.source]
    for number in without:
        print(f"{number.page}:{number.line}: {number.written}  NO SOURCE")
    print(f"{len(numbers)} numbers, {len(without)} without a source")
    return 1 if without else 0


if __name__ == "__main__":
    sys.exit(main([Path(name).resolve() for name in sys.argv[1:]] or PAGES))
