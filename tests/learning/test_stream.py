"""Experience is learned as it is read: any number of transitions, in memory that does not grow with it."""

from __future__ import annotations

import itertools
import json
import subprocess
import sys
from pathlib import Path

import pytest

from cleancli.cli.main import run
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.diagnostics.render import render
from cleancli.language.load import load_domain, read_source
from cleancli.learning import experience
from cleancli.learning.experience import read_experience

GOLDEN = Path(__file__).parents[1] / "golden"
DOMAIN = load_domain(read_source(GOLDEN / "domain.nid"))
LINES = (GOLDEN / "experience.jsonl").read_text(encoding="utf-8").splitlines()[:3]
TYPE = DOMAIN.types[0].name
TEXT = "".join(f"{line}\n" for line in LINES)


def test_line_ends_and_empty_lines_do_not_matter_and_a_torn_last_line_is_passed_over(tmp_path: Path) -> None:
    path = tmp_path / "e.jsonl"
    path.write_text(TEXT, encoding="utf-8")
    three = tuple(read_experience(path, DOMAIN))
    assert len(three) == len(LINES)
    odd = [TEXT.replace("\n", "\r\n"), "\n" + TEXT.replace("\n", "\n \n"), TEXT + LINES[0]]
    for text, expected in (*((text, three) for text in odd), ("", ()), ("\n", ()), (LINES[0], ())):
        path.write_bytes(text.encode())
        assert tuple(read_experience(path, DOMAIN)) == expected


def test_a_separator_of_lines_within_a_name_ends_no_line(tmp_path: Path) -> None:
    path = tmp_path / "e.jsonl"
    named = f'"objects": {{"a\u2028b\u0085c": "{TYPE}", '
    path.write_text(TEXT.replace('"objects": {', named), encoding="utf-8")
    assert len(tuple(read_experience(path, DOMAIN))) == len(LINES)


def test_mistakes_have_their_places_and_lines_however_far_down(tmp_path: Path) -> None:
    path = tmp_path / "e.jsonl"
    wrong = {3: "{}", 4: '["no"]', 9: "é" * 5000, 12: "[" * 100_000, 20: "\x1b[2J"}
    lines = [wrong.get(number, LINES[number % 3]) for number in range(25)]
    path.write_text("".join(f"{line}\n" for line in lines), encoding="utf-8")
    stream = read_experience(path, DOMAIN)
    assert len(tuple(itertools.islice(stream, 20))) == 20, "what is right is read"
    with pytest.raises(Refused) as refused:
        tuple(stream)
    shown = render(refused.value.diagnostics, refused.value.sources)
    for number, text in wrong.items():
        assert f"{path}:{number + 1}:1: error[E701]" in shown
        assert repr(text[:4])[1:-1] in shown
    assert len(refused.value.diagnostics) == len(wrong)


def test_bytes_that_are_no_text_are_told_with_their_line(tmp_path: Path) -> None:
    path = tmp_path / "e.jsonl"
    path.write_bytes(TEXT.encode() + b"\xff\xfe\n" + TEXT.encode())
    with pytest.raises(Refused, match="byte 0xff is no UTF-8 text"):
        tuple(read_experience(path, DOMAIN))


def test_a_line_has_a_limit_and_so_has_what_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "e.jsonl"
    monkeypatch.setattr(experience, "LONGEST", 2048)
    path.write_text(TEXT + "x" * 2048 + "\n")
    with pytest.raises(Refused, match=r"E005\]: line 4 of `.*` is longer than 2 KiB"):
        tuple(read_experience(path, DOMAIN))
    monkeypatch.setattr(experience, "MOST", 10)
    path.write_text("{}\n" * 25)
    with pytest.raises(Refused, match="15 more lines") as refused:
        tuple(read_experience(path, DOMAIN))
    assert len(refused.value.diagnostics) == 11


def test_lines_of_another_domain_are_told_once(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "e.jsonl"
    record = json.loads(LINES[0])
    others = [json.dumps(record | {"action": f"fly{each % 9}"}) for each in range(300)]
    path.write_text(TEXT + "\n" + "".join(f"{line}\n" for line in others) + "{}\n")
    with pytest.raises(Refused) as refused:
        tuple(read_experience(path, DOMAIN))
    assert len(refused.value.diagnostics) == 2
    assert run(["learn", str(GOLDEN / "domain.nid"), str(path)]) == 1
    told = capsys.readouterr().err
    named = "`fly0`, `fly1`, `fly2`, `fly3`, `fly4` and others"
    assert (
        f"{path}:5:1: error[E701]: 300 of 304 lines name actions that `{DOMAIN.name}` lacks: {named}" in told
    )
    assert f"help: is `{DOMAIN.name}` the domain that the experience is of?" in told
    assert f"{path}:305:1: error[E701]: not a transition" in told
    assert max(len(line) for line in told.splitlines() if set(line) <= set(" |^")) <= 80


def test_a_line_whose_action_is_lacking_is_told_after_any_number_of_others(tmp_path: Path) -> None:
    path = tmp_path / "e.jsonl"
    path.write_text("{}\n" * 150 + LINES[0].replace('"action": "', '"action": "un') + "\n")
    with pytest.raises(Refused, match="has no action 'un") as refused:
        tuple(read_experience(path, DOMAIN))
    assert "52 more lines" in refused.value.diagnostics[-1].message
    assert len(refused.value.diagnostics) == 100


def test_a_wrong_line_anywhere_keeps_everything_from_being_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    mine, right, wrong = (tmp_path / name for name in ("mine.nid", "right.jsonl", "wrong.jsonl"))
    mine.write_bytes((GOLDEN / "domain.nid").read_bytes())
    right.write_text(TEXT)
    wrong.write_text(TEXT * 3 + "{}\n")
    words = ["learn", *map(str, (mine, right, wrong))]
    assert run([*words, "--write"]) == 1
    assert "wrong.jsonl:10:1: error[E701]" in capsys.readouterr().err
    assert mine.read_bytes() == (GOLDEN / "domain.nid").read_bytes()
    assert run([*words[:-1], "--write"]) == 0
    assert mine.read_bytes() != (GOLDEN / "domain.nid").read_bytes()


MEASURED = """
import resource, sys
from cleancli.cli.main import run
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
code = run(["learn", sys.argv[1], sys.argv[2], "--json"])
print(code, (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) >> 10, file=sys.stderr)
"""


def test_a_file_larger_than_any_text_is_learned_in_little_memory(tmp_path: Path) -> None:
    """Each line is its own, so that nothing can be kept of them; a text of this size is refused (E005)."""
    path = tmp_path / "e.jsonl"
    number = 6_000
    record = json.loads(LINES[0])
    with path.open("w") as file:
        for each in range(number):
            file.write(json.dumps(record | {"note": f"{each} " + "x" * 1500}) + "\n")
    assert path.stat().st_size > 8 << 20
    command = [sys.executable, "-c", MEASURED, str(GOLDEN / "domain.nid"), str(path)]
    measured = subprocess.run(command, capture_output=True, text=True)
    code, megabytes = map(int, measured.stderr.split())
    assert code == 0
    assert sum(entry["examples"] for entry in json.loads(measured.stdout)["rules"]) == number
    # What the command loads, and what reading the grammar takes; the file alone is 9 MB as bytes.
    assert megabytes < 90
