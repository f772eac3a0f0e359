"""Standard streams that are closed, full, or read by nobody end every command as docs/exit-codes.md says."""

from __future__ import annotations

import shlex
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
CLEANCLI = f"{shlex.quote(sys.executable)} -m cleancli.cli.main"
NOISE = ("Traceback", "Exception ignored", "Errno")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a file to format, and one with a thousand mistakes."""
    folder = tmp_path_factory.mktemp("streams")
    shutil.copy(ROOT / "domains" / "cleaning.nid", folder)
    shutil.copytree(ROOT / "tests" / "conversion" / "kitchen", folder / "kitchen")
    bad = "\n".join(f"  rule r{n} {{ on f(?a) }}" for n in range(1000))
    (folder / "bad.nid").write_text(f"domain bad {{\n{bad}\n}}\n")
    (folder / "untidy.nid").write_text((folder / "cleaning.nid").read_text().replace("  ", "\t"))
    return folder


def shell(line: str, folder: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        ["bash", "-c", line],
        capture_output=True,
        text=True,
        cwd=folder,
        timeout=120,
        stdin=subprocess.DEVNULL,
    )


def quiet(text: str) -> bool:
    return not any(word in text for word in NOISE)


PRINTING = [
    "--help",
    "check bad.nid",
    "check bad.nid --json",
    "fmt --diff untidy.nid",
    "show cleaning three_areas",
    "compile cleaning three_areas",
    "explain cleaning three_areas 'moveToContainerFast(a1)'",
    "rename dirt dust --domain cleaning.nid",
    "plan cleaning three_areas --samples 50 --explain",
    "plan cleaning three_areas --samples 50 --json",
    "simulate cleaning three_areas --episodes 2 --samples 20 --json",
    "execute cleaning three_areas --seed 5 --samples 50 --json",
    "learn cleaning runs/three_areas-seed5-001",
    "report runs/three_areas-seed5-001 --json",
    "convert kitchen --out converted --force",
    "fmt -",
]


# One process for each command, but all of one that has loaded already what they need.
EACH = """
import os, shlex, sys
from cleancli.cli.main import main, run
run("execute cleaning three_areas --seed 5 --samples 50 --quiet".split())
for number, words in enumerate(open("commands").read().splitlines()):
    reading, writing = os.pipe()
    os.close(reading)
    if os.fork() == 0:
        os.dup2(writing, 1)
        os.dup2(os.open(f"said-{number}", os.O_WRONLY | os.O_CREAT), 2)
        if "-" in words.split():
            os.dup2(os.open("cleaning.nid", os.O_RDONLY), 0)
        try:
            main(shlex.split(words))
        except SystemExit as ended:
            os._exit(ended.code)
    os.close(writing)
    print(os.waitstatus_to_exitcode(os.wait()[1]), file=sys.stderr)
"""


def test_a_reader_who_goes_ends_every_command_without_a_word(folder: Path) -> None:
    """The reader has gone before the first line: a command meets it whenever it prints."""
    (folder / "commands").write_text("\n".join(PRINTING))
    command = [sys.executable, "-W", "ignore::DeprecationWarning", "-c", EACH]  # 3.12 and later warn of fork
    ended = subprocess.run(
        command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, timeout=300
    )
    assert ended.returncode == 0, ended.stderr
    codes = dict(zip(PRINTING, map(int, ended.stderr.split()), strict=True))
    assert codes == dict.fromkeys(PRINTING, 5)
    for number, words in enumerate(PRINTING):
        assert quiet((folder / f"said-{number}").read_text()), words


def test_nothing_complains_when_the_process_ends(folder: Path) -> None:
    for words in ("show cleaning", "check bad.nid"):
        ended = shell(f"({CLEANCLI} {words}; echo $? >&2) | true", folder)
        assert ended.stderr == "5\n"


@pytest.mark.parametrize(
    ("line", "code", "says"),
    [
        ("{} check cleaning >&-", 5, "error: standard output: Bad file descriptor"),
        ("{} check cleaning > /dev/full", 5, "error: standard output: No space left on device"),
        ("{} check bad.nid > /dev/full", 5, "error: standard output: No space left on device"),
        ("{} --help >&-", 5, "error: standard output: Bad file descriptor"),
        ("{} check - <&- 2>&1", 1, "cannot read `<stdin>`: Bad file descriptor"),
        ("{} fmt - <&-", 1, "cannot read `<stdin>`: Bad file descriptor"),
        ("{} check bad.nid 2>&-", 1, ""),
        ("{} check nothing 2> /dev/full", 1, ""),
        ("{} frobnicate 2>&-", 2, ""),
        ("{} fmt cleaning.nid --check <&- >&- 2>&-", 5, ""),
    ],
)
def test_closed_and_full_streams(line: str, code: int, says: str, folder: Path) -> None:
    ended = shell(line.format(CLEANCLI), folder)
    assert (ended.returncode, quiet(ended.stderr)) == (code, True), ended.stderr
    assert says in ended.stderr + ended.stdout


def test_no_file_becomes_a_closed_stream(folder: Path) -> None:
    """Without standard streams the first files opened would get their numbers, and what is printed."""
    before = (folder / "cleaning.nid").read_bytes()
    for words in ("fmt cleaning.nid", "show cleaning.nid", "check bad.nid"):
        shell(f"{CLEANCLI} {words} <&- >&- 2>&-", folder)
    assert (folder / "cleaning.nid").read_bytes() == before


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_what_is_ended_from_outside_says_so(number: signal.Signals, folder: Path) -> None:
    command = [sys.executable, "-c", "from cleancli.cli.main import main; main(['fmt', '-'])"]
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, cwd=folder, text=True
    ) as process:
        while not _waits(process.pid):
            time.sleep(0.02)
        process.send_signal(number)
        said = process.communicate(timeout=60)[1]
    assert (process.returncode, said.strip()) == (130, "interrupted")


def _waits(process: int) -> bool:
    """Whether a process reads from a pipe that has nothing to read."""
    return "pipe" in Path(f"/proc/{process}/wchan").read_text()


def test_nohup_is_heeded(folder: Path) -> None:
    ended = shell(f"trap '' HUP; {CLEANCLI} fmt - < cleaning.nid & kill -HUP $!; wait $!", folder)
    assert ended.returncode == 0
