"""The commands that the documents show do what they say: each runs, in the page's order, and succeeds."""

from __future__ import annotations

import itertools
import json
import re
import shlex
import shutil
from pathlib import Path

import pytest

from cleancli.cli.command_table import COMMANDS
from cleancli.cli.main import run
from support import docs_numbers
from support.docs_numbers import Passage, named_commands, passages, sourced

ROOT = Path(__file__).parent.parent
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
FOLLOWED = {"tutorial"}
"""Pages of which test_tutorial.py does all that they say."""


def commands(page: Path) -> list[list[str]]:
    """Arguments of every `cleancli ...` line in the page's sh blocks."""
    blocks = re.findall(r"^```sh\n(.*?)^```$", page.read_text(encoding="utf-8"), re.M | re.S)
    lines = [line for block in blocks for line in block.splitlines()]
    return [shlex.split(line, comments=True) for line in lines if line.startswith("cleancli ")]


@pytest.mark.parametrize(
    "page", [p for p in PAGES if commands(p) and p.stem not in FOLLOWED], ids=docs_numbers.called
)
def test_commands_of_the_page_succeed(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    shutil.copy(ROOT / "domains" / "cleaning.nid", tmp_path / "my_cleaning.nid")
    shutil.copytree(ROOT / "tests" / "conversion" / "kitchen", tmp_path / "kitchen")
    shutil.copytree(ROOT / "tests" / "conversion" / "tidy", tmp_path, dirs_exist_ok=True)
    if page == ROOT / "docs" / "recording.md":
        bags = pytest.importorskip("support.recorded_table", reason="rosbags is an extra")
        bags.write(tmp_path / "table.mcap")
    for words in commands(page):
        assert run(words[1:]) == 0, shlex.join(words)


def anchors(page: Path) -> set[str]:
    """What links can name in a page: its headings, as hosts of git repositories turn them into anchors."""
    headings = re.findall(r"^#+ (.*)$", page.read_text(encoding="utf-8"), re.M)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def test_links_lead_somewhere() -> None:
    for page in [*PAGES, ROOT / "ARCHITECTURE.md", ROOT / "CONTRIBUTING.md"]:
        links = re.findall(r"\]\(([^)#:]*)(?:#([^)]+))?\)", page.read_text(encoding="utf-8"))
        for target, anchor in links:
            place = page.parent / target if target else page
            assert place.exists(), f"{page.name} -> {target}"
            assert not anchor or anchor in anchors(place), f"{page.name} -> {target}#{anchor}"


def test_files_that_recipes_name_are_there() -> None:
    """Paths in CONTRIBUTING.md, from the root or from the sources; NAME stands for what a reader chooses."""
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    named = [word for word in re.findall(r"`([\w./-]+/[\w./-]*)`", text) if "NAME" not in word]
    assert len(named) > 30
    for path in named:
        places = (ROOT / path, ROOT / "src" / "cleancli" / path, ROOT / path.removeprefix("/"))
        assert any(place.exists() for place in places), path


def test_functions_and_classes_that_pages_name_are_there() -> None:
    """Whatever stands alone in code marks and looks like a name of ours: `module.name`, `ClassName`."""
    elsewhere = {"init.lua", "name.txt", "vim.lsp.config"}  # of other programs, and a file of tests
    code = [path.read_text(encoding="utf-8") for path in (ROOT / "src").rglob("*.py")]
    code += [path.read_text(encoding="utf-8") for path in (ROOT / "benchmarks").glob("*.py")]
    defined = set(re.findall(r"[A-Za-z_]\w*", " ".join(code)))
    missing = []
    for page in [*PAGES, *ROOT.glob("*.md")]:
        marked = set(re.findall(r"`([^`\n]+)`", page.read_text(encoding="utf-8"))) - elsewhere
        names = {m for m in marked if re.fullmatch(r"[A-Z][a-z][A-Za-z]*|[a-z_]+(\.[A-Za-z_]+)+", m)}
        missing += [f"{page.name}: {name}" for name in sorted(names) if name.split(".")[-1] not in defined]
    assert not missing


README = (ROOT / "README.md").read_text(encoding="utf-8")


def test_readme_states_the_two_commands() -> None:
    assert "<!-- test command -->\n```sh\n" in README, ".ci/run finds the test command by this mark"
    assert "cleancli execute cleaning two_groups --seed 1\n" in README


def test_the_readme_fits_the_site() -> None:
    """At 1280 pixels a line of code has room for 80 signs; at 400 a table shows its first column."""
    (first, *_) = re.findall(r"^```sh\n(.*?)^```$", README, re.M | re.S)
    assert max(map(len, first.splitlines())) <= 80
    rows = re.findall(r"^\| (?!what)(.*?) \| .*\|$", README, re.M)
    assert len(rows) >= 10
    assert all("](docs/" in row for row in rows)


def test_the_first_run_ends_as_the_readme_says(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """But for real time: that of planning and looking, which the total holds."""
    monkeypatch.chdir(tmp_path)
    assert run(["execute", "cleaning", "two_groups", "--seed", "1"]) == 0
    (summary,) = re.findall(r"^```text\n(clean: .*?)^```$", README, re.M | re.S)
    real_time = re.compile(r"(seconds:|planning|perceiving|perceptions) [\d.]+")
    assert real_time.sub(r"\1", capsys.readouterr().out) == real_time.sub(r"\1", summary)


def test_commands_of_the_table_are_run_from_some_page() -> None:
    """What the README offers begins a command that a page shows, and that is so carried out by a test."""
    table = re.findall(r"^\| .* \|$", README, re.M)
    offered = [command.split() for row in table for command in re.findall(r"`(cleancli [^`]+)`", row)]
    assert len(offered) >= 8
    shown = [words for page in PAGES for words in commands(page)]
    for words in offered:
        assert any(words == other[: len(words)] for other in shown), " ".join(words)


@pytest.mark.parametrize("page", docs_numbers.PAGES, ids=docs_numbers.called)
def test_every_number_names_its_source(page: Path) -> None:
    """docs/decisions/0010; `python tests/support/docs_numbers.py` lists them all."""
    numbers = list(sourced(docs_numbers.called(page), page.read_text(encoding="utf-8")))
    assert [f"line {number.line}: {number.written}" for number in numbers if not number.source] == []


def with_what_it_imports(script: Path) -> str:
    """The text of a benchmark and of those in its folder whose options it takes over."""
    text = script.read_text(encoding="utf-8")
    others = (script.parent / f"{name}.py" for name in re.findall(r"^from (\w+) import", text, re.M))
    return "".join((text, *(other.read_text(encoding="utf-8") for other in others if other.exists())))


@pytest.mark.parametrize("page", docs_numbers.PAGES, ids=docs_numbers.called)
def test_commands_that_make_numbers_are_there(page: Path) -> None:
    for command in named_commands(page.read_text(encoding="utf-8")):
        words = command.split()
        if words[0] == "cleancli":
            assert words[1] in COMMANDS, command
        elif words[0] == "python":
            text = with_what_it_imports(ROOT / words[1])
            for option in (word for word in words if word.startswith("--") and word != "--help"):
                assert f'"{option}"' in text, f"{command}: {words[1]} has no {option}"
        else:
            assert (ROOT / words[-1].partition("::")[0]).exists(), command


@pytest.mark.parametrize("page", sorted((ROOT / "docs").glob("*.md")), ids=docs_numbers.called)
def test_sources_of_a_section_or_a_page_stand_at_its_end(page: Path) -> None:
    """docs/decisions/0010: nobody has to read past them."""
    parts = list(passages(docs_numbers.called(page), page.read_text(encoding="utf-8")))
    for part, following in itertools.pairwise(parts):
        if part.text.startswith("Numbers of this page:"):
            assert following.text.startswith("Numbers of this page:"), f"line {part.line}"
        if part.text.startswith("Numbers of this section:"):
            assert following.kind == "heading" or following.text.startswith("Numbers of this")


@pytest.mark.parametrize(
    "name",
    ["editors", "execution", "experiments", "language", "learning", "planning", "report", "simulation"],
)
def test_sentences_for_users_are_not_broken_by_paths_of_code(name: str) -> None:
    """Where a number comes from is said at the end; a section for programmers may name modules."""
    text = (ROOT / "docs" / f"{name}.md").read_text(encoding="utf-8").partition("## For programs")[0]
    paths = re.findall(r"\(`((?:\w+/)+\w+\.py)`\)", text)
    assert [path for path in paths if (ROOT / "src" / "cleancli" / path).exists()] == []


def test_a_number_without_a_source_is_found() -> None:
    """Of each way to name one, and of each way to miss."""
    page = """# Page

It takes 17 s.

It takes 18 s (`python benchmarks/world.py`).

Rags are 12 cm wide, and 13 cm long (`scene/grasps.py`).

Measured by `cleancli act`:

| a | b |
|---|---|
| 19 | 20 |

After it comes 21.

## Another section

- 22 items
- 23 (`tests/world`)

Numbers of this section: `motion/pace.py`.

- The tool goes 0.2 m/s, or 25 cm/s, or 26 cm/s, E602, `27`, §4.2, seed 28, in 2 ways.
"""
    found = {number.written: number.source for number in sourced("page", page)}
    assert [written for written, source in found.items() if not source] == ["17", "13", "21", "22", "26"]
    assert found["18"] == "python benchmarks/world.py"
    assert found["12"] == "scene/grasps.py"
    assert found["19"] == found["20"] == "cleancli act"
    assert found["0.2"] == found["25"] == "motion/pace.py"
    assert not {"602", "27", "28", "2", "4.2"} & found.keys()


def test_a_page_is_cut_into_passages() -> None:
    page = "# Head\nText\nof two lines\n- one\n  more\n- two\n\n| a |\n| b |\n```\n# code\n\n- x\n```\nEnd"
    assert [(part.kind, part.line) for part in passages("page", page)] == [
        ("heading", 1),
        ("text", 2),
        ("item", 4),
        ("item", 6),
        ("table", 8),
        ("code", 10),
        ("text", 15),
    ]
    assert Passage("page", 1, 0, "text", "by `python\nbenchmarks/world.py 3`").names() == (
        "python benchmarks/world.py 3",
    )


def test_options_of_a_run_are_those_that_the_document_lists(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert run(["execute", "cleaning", "three_areas", "--seed", "1", "--samples", "200", "--quiet"]) == 0
    told = json.loads((tmp_path / "runs" / "three_areas-seed1-001" / "run.json").read_text(encoding="utf-8"))
    text = (ROOT / "docs" / "runs.md").read_text(encoding="utf-8")
    rows = {
        name: set(re.findall(r"`(\w+)`", meaning.partition(":")[2]))
        for name, meaning in re.findall(r"^\| `(\w+)` \| (.*) \|$", text, re.MULTILINE)
    }
    assert set(told["options"]) == rows["options"]
    assert told.keys() <= rows.keys()


def test_the_mistakes_that_the_comparison_shows_are_all_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    page = (ROOT / "docs" / "comparison.md").read_text(encoding="utf-8")
    (shown,) = re.findall(r"^```pddl\n(.*?)^```$", page, re.M | re.S)
    monkeypatch.chdir(tmp_path)
    Path("errand.pddl").write_text(shown, encoding="utf-8")
    assert run(["check", "errand.pddl"]) == 1
    told = "".join(capsys.readouterr())
    for name, meant in (("robot_att", "robot_at"), ("lie_in", "lies_in")):
        before = shown.partition(f"({name} ")[0] + "("
        line, column = before.count("\n") + 1, len(before.rpartition("\n")[2]) + 1
        assert re.search(rf"errand.pddl:{line}:{column}: error\[E\d+\]: unknown predicate `{name}`", told)
        assert f"did you mean `{meant}`?" in told
