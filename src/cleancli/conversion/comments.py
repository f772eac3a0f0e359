"""Comments in the texts of converted files."""

from __future__ import annotations

from collections.abc import Iterable, Mapping


def commented(text: str, head: Iterable[str], above: Mapping[str, tuple[str, ...]]) -> str:
    """The text with comments at its head, and above the first line that begins with each key."""
    waiting = dict(above)
    lines = [f"# {_plain(line)}" for line in head] + [""]
    for line in text.splitlines():
        for key in [key for key in waiting if line.startswith(key)]:
            indent = key[: len(key) - len(key.lstrip())]
            lines += [f"{indent}# {_plain(remark)}" for remark in waiting.pop(key)]
        lines.append(line)
    return "\n".join(lines) + "\n"


def _plain(remark: str) -> str:
    """Names of files may hold anything."""
    return " ".join(remark.split())
