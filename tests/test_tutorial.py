"""The tutorial, followed word by word in an environment that holds the wheel, what it asks for, and no more.

Its files are written, its commands carried out in order, and what they print and draw is what the page shows.
CLEANCLI_REGENERATE=1 writes anew what differs, but for outputs of which the page leaves lines out.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np

from support.empty_environment import install
from support.pictures import picture
from support.printed import agree

ROOT = Path(__file__).parent.parent
PAGE = ROOT / "docs" / "tutorial.md"
REGENERATES = bool(os.environ.get("CLEANCLI_REGENERATE"))
_PART = re.compile(
    r"^```(?P<kind>\w+)\n(?P<text>.*?)^```$|^!\[[^\]]*\]\(pictures/tutorial/(?P<picture>[^)]+)\)$",
    re.M | re.S,
)


def file_named(before: str) -> str:
    """The file into which a reader is told to write what follows this text."""
    paragraph = before.rstrip().rpartition("\n\n")[2]
    assert paragraph.endswith(":"), paragraph
    return str(re.findall(r"`(\w+\.nid)`", paragraph)[-1])


def same_picture(made: Path, kept: Path) -> bool:
    """Whether two pictures differ by no more than the rounding of another processor makes."""
    first, second = picture(made).astype(np.int64), picture(kept).astype(np.int64)
    return first.shape == second.shape and float((abs(first - second) > 32).mean()) < 0.002


class Reader:
    """Somebody who does what the page says in a folder of their own."""

    def __init__(self, folder: Path, programs: Path) -> None:
        self.folder = folder
        inherited = {key: value for key, value in os.environ.items() if key not in ("PYTHONPATH", "COLUMNS")}
        self.environment = inherited | {"PATH": f"{programs}:{os.environ['PATH']}"}
        self.printed = ""

    def carry_out(self, commands: str, shown: str | None) -> None:
        """Each line; only what the page shows to be a mistake may fail."""
        self.printed = ""
        for command in commands.splitlines():
            done = subprocess.run(
                ["bash", "-c", f"{command} 2>&1"],
                cwd=self.folder,
                env=self.environment,
                stdout=subprocess.PIPE,
                text=True,
                timeout=300,
            )
            self.printed += done.stdout
            is_mistake = shown is not None and "error[" in shown
            assert (done.returncode != 0) is is_mistake, f"{command}\n{done.stdout}"


def parts(page: str) -> list[tuple[re.Match[str], re.Match[str] | None]]:
    """Files, commands and pictures in order, each with the output that follows it."""
    found = list(_PART.finditer(page))
    following: list[re.Match[str] | None] = [*found[1:], None]
    pairs = zip(found, following, strict=True)
    return [
        (part, after if after is not None and after["kind"] == "text" else None)
        for part, after in pairs
        if part["kind"] != "text"
    ]


def check_picture(reader: Reader, name: str) -> None:
    made, kept = reader.folder / name, PAGE.parent / "pictures" / "tutorial" / name
    if REGENERATES and not (kept.exists() and same_picture(made, kept)):
        kept.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(made, kept)
    assert same_picture(made, kept), f"{name} is not what the commands draw"


def test_the_tutorial_does_what_it_says(tmp_path: Path) -> None:
    page = PAGE.read_text(encoding="utf-8")
    folder = tmp_path / "cafe"
    folder.mkdir()
    installing, *followed = parts(page)
    assert ".venv/bin/pip install -q '.[experiments]'\n" in installing[0]["text"]
    reader = Reader(folder, install(tmp_path, "experiments"))
    changed, different = list[tuple[int, int, str]](), list[str]()
    for part, output in followed:
        if part["picture"]:
            check_picture(reader, part["picture"])
        elif part["kind"] == "nid":
            written = reader.folder / file_named(page[: part.start()])
            written.write_text(part["text"], encoding="utf-8")
        else:
            assert part["kind"] == "sh", part["kind"]
            shown = None if output is None else output["text"]
            reader.carry_out(part["text"], shown)
            if output is not None and not agree(output["text"], reader.printed):
                if REGENERATES and "...\n" not in output["text"]:
                    changed.append((*output.span("text"), reader.printed))
                else:
                    different.append(f"{part['text']}{reader.printed}")
    for begin, end, printed in reversed(changed):
        page = page[:begin] + printed + page[end:]
    if changed:
        PAGE.write_text(page, encoding="utf-8")
    assert not different, "\n".join(different)


def test_what_a_page_shows_is_compared_line_by_line() -> None:
    assert agree("a  1\n...\nz\n", "a 1\nb\nc\nz\n")
    assert agree("a\n...\n", "a\n")
    assert not agree("a\n...\nz\n", "a\nz\nb\n")
    assert not agree("reward 1.5\n", "reward 1.6\n")
    assert agree("seconds: search 0.01\n", "seconds: compile 2.5, search 0.02\n")
    row = "uct {} ± 0.1 3 100.0 (72.2 to 100.0) {}\n"
    assert agree(row.format(1.0, "0.1 0.4"), row.format(1.0, "9.1 99.2"))
    assert not agree(row.format(1.0, "0.1 0.4"), row.format(2.0, "0.1 0.4"))
