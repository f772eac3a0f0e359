"""Shell completion, asked as a shell asks."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import click
import pytest

from cleancli.cli.command_table import COMMANDS
from cleancli.cli.main import cli

ROOT = Path(__file__).parent.parent.parent


def completed(line: str, cwd: Path) -> list[str]:
    """What bash is offered for the last word of a line; a file for it to complete is `(file)`."""
    words = line.split(" ")
    result = subprocess.run(
        [sys.executable, "-m", "cleancli.cli.main"],
        capture_output=True,
        text=True,
        cwd=cwd,
        env={
            **os.environ,
            "_CLEANCLI_COMPLETE": "bash_complete",
            "COMP_WORDS": line,
            "COMP_CWORD": str(len(words) - 1),
        },
        timeout=60,
        check=True,
    )
    assert result.stderr == ""
    kinds = [entry.partition(",") for entry in result.stdout.splitlines() if entry]
    return [value if kind == "plain" else f"({kind})" for kind, _, value in kinds]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "clean_kitchen.nid").write_text("domain kitchen {\n  actions { wash(?p - plate) }\n")
    (tmp_path / "notes.txt").touch()
    (tmp_path / "more").mkdir()
    (tmp_path / "more" / "deep.nid").touch()
    (tmp_path / ".hidden").mkdir()
    return tmp_path


@pytest.mark.parametrize(
    ("line", "offered"),
    [
        ("cleancli expl", ["explain"]),
        ("cleancli plan cl", ["clean_kitchen.nid", "cleaning"]),
        ("cleancli execute cleaning two", ["two_groups"]),
        ("cleancli show cleaning three", ["three_areas"]),
        ("cleancli check ", None),
        ("cleancli fmt ", ["clean_kitchen.nid", "more/"]),
        ("cleancli fmt more/", ["more/deep.nid"]),
        ("cleancli fmt mo", ["(file)"]),
        ("cleancli explain cleaning three_areas jo", ["join2(", "join3("]),
        ("cleancli explain clean_kitchen.nid three_areas ", ["wash("]),
        ("cleancli explain nowhere three_areas jo", []),
        (
            "cleancli rename --domain cleaning pick_",
            ["pick_big", "pick_medium", "pick_scattered", "pick_small"],
        ),
        ("cleancli rename --domain cleaning dirt", ["dirt", "dirty_areas"]),
        ("cleancli rename wa", ["wash"]),
        ("cleancli plan cleaning --sam", ["--samples"]),
        ("cleancli check --format j", ["json"]),
    ],
)
def test_what_is_offered(line: str, offered: list[str] | None, folder: Path) -> None:
    found = completed(line, folder)
    if offered is None:
        folders = (ROOT / kind for kind in ("domains", "problems", "studies"))
        shipped = {file.stem for folder in folders for file in folder.glob("*.nid")}
        offered = [*sorted(["clean_kitchen.nid", *shipped]), "more/"]
    assert found == offered


@pytest.mark.parametrize("name", COMMANDS)
def test_what_completes_is_what_the_command_reads(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """A line is completed without importing its command; the command itself reads the same arguments."""
    context = click.Context(cli)
    real = cli.get_command(context, name)
    assert real is not None
    monkeypatch.setenv("_CLEANCLI_COMPLETE", "bash_complete")
    monkeypatch.setenv("COMP_WORDS", f"cleancli {name} ")
    light = cli.get_command(context, name)
    assert light is not None
    if name in ("rename", "lsp", "robot"):  # never complete without an option, and without arguments
        assert light is real
        return
    read, offered = ([p for p in c.params if isinstance(p, click.Argument)] for c in (real, light))
    assert [(p.name, p.nargs, p._custom_shell_complete) for p in read] == [
        (p.name, p.nargs, p._custom_shell_complete) for p in offered
    ]
    assert not any(p.required for p in offered)


@pytest.mark.parametrize("line", ["cleancli execute cl", "cleancli check "])
def test_names_of_files_load_nothing_heavy(line: str, folder: Path) -> None:
    script = (
        "import sys\n"
        "from cleancli.cli.main import run\n"
        "try:\n    run([])\n"
        "except SystemExit:\n    pass\n"
        "print({'lark', 'numpy', 'rich', 'pybullet'} & sys.modules.keys(), file=sys.stderr)\n"
    )
    environment = {**os.environ, "_CLEANCLI_COMPLETE": "bash_complete", "COMP_WORDS": line, "COMP_CWORD": "2"}
    result = subprocess.run(
        [sys.executable, "-c", script],
        capture_output=True,
        text=True,
        cwd=folder,
        env=environment,
        check=True,
    )
    assert "cleaning" in result.stdout
    assert result.stderr == "set()\n"


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_each_shell_gets_its_script(shell: str, tmp_path: Path) -> None:
    """bash itself is asked for its version first, and may be missing."""
    from click.shell_completion import get_completion_class

    kind = get_completion_class(shell)
    assert kind is not None
    script = kind(cli, {}, "cleancli", "_CLEANCLI_COMPLETE")
    assert f"_CLEANCLI_COMPLETE={shell}_complete" in script.source_template % script.source_vars()
