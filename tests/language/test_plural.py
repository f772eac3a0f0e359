"""Numbers of things in sentences: `1 action`, `2 actions`, by one function."""

from __future__ import annotations

import re
from pathlib import Path

from cleancli.files.plain import in_units
from cleancli.language.diagnostics.plural import plural

ROOT = Path(__file__).parents[2]
BY_HAND = re.compile(r"""(['"])s\1 ?\* ?\(|(['"])s\2 if |(['"])\3 if [^'"]*== 1 else (['"])s\4""")
VERBS = {"has", "is", "was", "stands", "takes"}


def test_one_and_several() -> None:
    assert [plural(number, "action") for number in (0, 1, 2)] == ["0 actions", "1 action", "2 actions"]
    assert [plural(n, "fact holds", "facts hold") for n in (0, 1, 2)] == [
        "0 facts hold",
        "1 fact holds",
        "2 facts hold",
    ]
    assert in_units(1) == "1 byte"


def test_no_ending_is_made_by_hand() -> None:
    made = "f\"{n} time{'s' * (n != 1)}\"", "f\"{n} time{'' if n == 1 else 's'}\""
    assert all(BY_HAND.search(text) for text in made)
    files = [path for path in (ROOT / "src").rglob("*.py") if path.name != "plural.py"]
    assert [path.name for path in files if BY_HAND.search(path.read_text(encoding="utf-8"))] == []


def test_no_message_has_one_of_several() -> None:
    texts = [path.read_text(encoding="utf-8") for path in (ROOT / "tests" / "cases").rglob("*.txt")]
    lines = [line for text in texts for line in text.splitlines() if not re.match(r"\s*\d* *\|", line)]
    ones = [word for line in lines for word in re.findall(r"(?<![\d.])1 ([a-z]+s)\b", line)]
    assert len(lines) > 500
    assert set(ones) <= VERBS
