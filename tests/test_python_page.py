"""The examples of docs/python.md and of the README run in the page's order, and print what the page says."""

from __future__ import annotations

import contextlib
import importlib.util
import io
import re
from pathlib import Path

import pytest

import cleancli

ROOT = Path(__file__).parent.parent
PAGE = ROOT / "docs" / "python.md"
EXAMPLE = re.compile(
    r"(<!-- needs pybullet -->\n)?^```python\n(.*?)^```$(?:\n\n^```text\n(.*?)^```$)?", re.M | re.S
)


def printed(code: str, names: dict[str, object]) -> str:
    with contextlib.redirect_stdout(io.StringIO()) as output:
        exec(compile(code, "example", "exec"), names)
    return output.getvalue()


def pattern(text: str) -> str:
    """What is printed, where `...` stands for anything."""
    return re.escape(text).replace(re.escape("..."), r"[\s\S]*?")


@pytest.mark.parametrize("page", [ROOT / "README.md", PAGE], ids=lambda page: page.stem)
def test_examples_print_what_the_page_says(
    page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    examples = EXAMPLE.findall(page.read_text(encoding="utf-8"))
    assert examples
    names: dict[str, object] = {}
    for needs_pybullet, code, output in examples:
        if needs_pybullet and importlib.util.find_spec("pybullet") is None:
            continue
        found = printed(code, names)
        assert re.fullmatch(pattern(output), found), f"{code}\nprints\n{found}"


def test_every_name_of_the_interface_has_an_example() -> None:
    code = "".join(code for _, code, _ in EXAMPLE.findall(PAGE.read_text(encoding="utf-8")))
    used = set(re.findall(r"\bcleancli\.(\w+)", code))
    assert used == set(cleancli.__all__) - {"__version__"}


def test_the_page_lists_every_argument() -> None:
    text = PAGE.read_text(encoding="utf-8")
    for name in set(cleancli.__all__) - {"__version__", "Refused", "load_domain", "load_problem"}:
        function = getattr(cleancli, name)
        (listed,) = re.findall(rf"`{name}\(([^`]*)\)`", text)
        stated = [word.strip(" *\n") for word in listed.replace("\n", " ").split(",")]
        code = function.__code__
        number = code.co_argcount + code.co_kwonlyargcount
        arguments = [*code.co_varnames[:number]]
        if code.co_flags & 4:
            arguments.insert(code.co_argcount, code.co_varnames[number])
        assert [word for word in stated if word] == arguments, name
