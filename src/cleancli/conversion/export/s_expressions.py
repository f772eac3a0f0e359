"""Nested lists in parentheses as text: on one line where they fit, else a part to a line."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

Node = str | tuple["Node", ...]
"""A word, or a list; a word that begins with `;` is a comment, and has a line to itself."""

WIDTH = 110
"""Characters of a line. Chosen, as for .nid files."""

_ON_FIRST_LINE = {"forall": 2, "exists": 2, "when": 2, ":action": 2, "define": 2}
"""How many parts of a list stay on its first line; one of all others."""


def laid_out(node: Node, indent: int = 0) -> str:
    """The text of a list whose first line is indented already."""
    if isinstance(node, str):
        return node
    flat = _flat(node)
    if flat is not None and indent + len(flat) <= WIDTH:
        return flat
    first = _ON_FIRST_LINE.get(node[0], 1) if node and isinstance(node[0], str) else 0
    lines = ["(" + " ".join(laid_out(part, indent + 2) for part in node[:first])]
    lines += [" " * (indent + 2) + line for line in _lines(node[first:], indent + 2)]
    return "\n".join(lines) + ("\n" + " " * indent + ")" if _is_comment(node[-1]) else ")")


def _flat(node: Node) -> str | None:
    """The list on one line; None where a comment is in it."""
    if isinstance(node, str):
        return None if _is_comment(node) else node
    parts = [_flat(part) for part in node]
    return None if None in parts else f"({' '.join(part for part in parts if part is not None)})"


def _lines(parts: Sequence[Node], indent: int) -> Iterator[str]:
    """A line, or several, for each part; a keyword or a number stands before the list that it belongs to."""
    before = ""
    for part in parts:
        if isinstance(part, str) and (part[0] == ":" or part[0].isdigit()):
            before += f"{part} "
        else:
            yield before + laid_out(part, indent)
            before = ""
    if before:
        yield before.rstrip()


def _is_comment(node: Node) -> bool:
    return isinstance(node, str) and node.startswith(";")
