"""A run's folder may be anybody's: it is refused with a sentence, and nothing is harmed."""

from __future__ import annotations

import hashlib
import io
import json
import os
import shutil
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cleancli.api.resuming import unfinished
from cleancli.cli.main import run
from cleancli.compiler.fluents import values_of
from cleancli.language.diagnostics.refused import Refused
from cleancli.learning.experience import Transition, encode
from cleancli.recording import run_folder
from cleancli.recording.arrays import BadArrays, packed, unpacked
from cleancli.recording.folder import read_inside
from cleancli.recording.journal import Resumed, read_journal
from cleancli.scene.calibration import Appearance, Calibration, Thresholds, as_text

WORDS = ["execute", "cleaning", "three_areas", "--seed", "5", "--samples", "50", "--quiet"]
ELSEWHERE = "somebody else's\n"


class Killed(BaseException):
    """Stands for a process that is gone."""


@pytest.fixture(scope="module")
def begun(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run that died after two actions, and so has two checkpoints."""
    runs = tmp_path_factory.mktemp("begun")
    checkpoint = run_folder.Recorder._checkpoint

    def dies(self: run_folder.Recorder, state: Any) -> None:
        checkpoint(self, state)
        if state.actions == 2:
            raise Killed

    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(run_folder.Recorder, "_checkpoint", dies)
        with pytest.raises(Killed):
            run([*WORDS, "--runs", str(runs)])
    return runs / "three_areas-seed5-001"


@pytest.fixture
def folder(begun: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A copy of it, in which a test may do what it likes."""
    monkeypatch.chdir(tmp_path)
    copy = Path(shutil.copytree(begun, tmp_path / "run"))
    (tmp_path / "elsewhere").write_text(ELSEWHERE)
    return copy


def content(folder: Path) -> dict[str, bytes]:
    """What is in all files."""
    files = (path for path in folder.rglob("*") if path.is_file() and not path.is_symlink())
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}


def refused(words: list[str], folder: Path, capsys: pytest.CaptureFixture[str], *says: str) -> str:
    """Run a command that is refused and changes nothing; returns what it says."""
    before = content(folder)
    assert run(words) == 1
    said = capsys.readouterr().err
    for each in says:
        assert each in said
    assert "Errno" not in said
    assert content(folder) == before
    return said


def resumed(folder: Path) -> list[str]:
    return ["execute", "--resume", str(folder), "--quiet"]


def edited(folder: Path, change: Callable[[dict[str, Any]], object]) -> None:
    header = json.loads((folder / "run.json").read_text())
    change(header)
    (folder / "run.json").write_text(json.dumps(header, indent=2))


# ---- files that are shorter than the checkpoint says


def test_a_run_goes_on_from_the_newest_checkpoint_that_fits_and_says_so(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    lines = (folder / "journal.jsonl").read_bytes().splitlines(keepends=True)
    (folder / "journal.jsonl").write_bytes(b"".join(lines[:-1]))
    assert run(["execute", "--resume", str(folder)]) == 0
    said = capsys.readouterr().err
    assert "002.npz` is no checkpoint to go on from: journal.jsonl has not the lines any more" in said
    assert "going on after 1 action\n" in said
    assert b"\0" not in (folder / "journal.jsonl").read_bytes()
    lines = (folder / "experience.jsonl").read_bytes().splitlines()
    numbers = [json.loads(line)["number"] for line in lines]
    assert numbers == list(range(1, len(numbers) + 1))


@pytest.mark.parametrize("name", ["journal.jsonl", "experience.jsonl"])
def test_a_run_whose_lines_are_gone_is_refused(
    name: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / name).write_bytes(b"")
    refused(resumed(folder), folder, capsys, "E706", "001.npz", "002.npz", name)


def test_a_file_that_was_cut_within_a_line_does_not_fit(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = folder / "experience.jsonl"
    path.write_bytes(path.read_bytes().replace(b"\n", b" "))
    refused(resumed(folder), folder, capsys, "E706", "has not the lines any more")


def test_a_run_that_has_lost_its_checkpoints_does_not_begin_anew(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    shutil.rmtree(folder / "state")
    refused(resumed(folder), folder, capsys, "E706", "has no checkpoint, though it had begun 2 actions")


# ---- checkpoints


def rewritten(folder: Path, change: Callable[[dict[str, Any], dict[str, Any]], object]) -> None:
    """Change what the checkpoints know: their arrays, and the JSON beside them."""
    for path in (folder / "state").iterdir():
        arrays = unpacked(path.read_bytes())
        rest = json.loads(arrays["rest"].tobytes())
        change(arrays, rest)
        if "rest" in arrays:
            arrays["rest"] = np.frombuffer(json.dumps(rest).encode(), np.uint8)
        path.write_bytes(packed(arrays))


EPISODES: dict[str, Callable[[dict[str, Any]], object]] = {
    "of another moment": lambda e: e.update(actions=7),
    "counts or seconds are absurd": lambda e: e.update(looks=-1),
    "Expected `int`": lambda e: e.update(looks="many"),
    "not of this domain": lambda e: e["situation"]["objects"].append({"name": "x", "type": "ghost"}),
    "not those of the problem": lambda e: e["situation"]["objects"].pop(),
    "the domain has no 'haunted'": lambda e: e["situation"]["state"].append(
        {"symbol": "haunted", "objects": ["a1"], "value": True}
    ),
    "rules that the domain has not": lambda e: e.update(examples=[[99, "1"]]),
    "the domain has no action 'fly'": lambda e: e.update(queue=[{"action": "fly", "objects": []}]),
    "about what the problem has not": lambda e: e.update(
        queue=[{"action": "moveToContainerFast", "objects": ["zz"]}]
    ),
    "no fraction": lambda e: e.update(
        rest=[{"name": "moveToContainerFast", "objects": ["a1"], "duration": 1, "cost": "1e9999999"}]
    ),
}


@pytest.mark.parametrize("says", EPISODES)
def test_an_episode_that_cannot_be_is_refused(
    says: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rewritten(folder, lambda _, rest: EPISODES[says](rest["episode"]))
    refused(resumed(folder), folder, capsys, "E706", says)


def test_what_is_no_text_is_refused(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Bytes of a checkpoint's JSON that are no UTF-8."""
    for path in (folder / "state").iterdir():
        arrays = unpacked(path.read_bytes())
        broken = arrays["rest"].tobytes().replace(b'"reason":""', b'"reason":"\xba"')
        path.write_bytes(packed({**arrays, "rest": np.frombuffer(broken, np.uint8)}))
    refused(resumed(folder), folder, capsys, "E706", "can't decode byte 0xba")


WORLDS: dict[str, Callable[[dict[str, Any]], object]] = {
    "facts that can change": lambda a: a.update(world_assignment=np.zeros((2, 2), np.int64)),
    "a value that it cannot have": lambda a: a.update(world_assignment=a["world_assignment"] + 1000),
    "no number": lambda a: a.update(world_clock=np.array(np.nan)),
    "clock is none": lambda a: a.update(world_clock=np.array(-1.0)),
    "it has no `rest`": lambda a: a.pop("rest"),
    "not one of this world": lambda a: a.pop("world_clock"),
}


@pytest.mark.parametrize("says", WORLDS)
def test_a_world_that_cannot_be_is_refused(
    says: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rewritten(folder, lambda arrays, _: WORLDS[says](arrays))
    refused(resumed(folder), folder, capsys, "E706", says)


def archive(**members: bytes) -> bytes:
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as packing:
        for name, data in members.items():
            packing.writestr(f"{name}.npy", data)
    return file.getvalue()


def header_of(shape: tuple[int, ...], data: bytes = b"") -> bytes:
    file = io.BytesIO()
    described = {"descr": "<f8", "fortran_order": False, "shape": shape}
    np.lib.format.write_array_header_1_0(file, described)
    return file.getvalue() + data


def pickle_of(array: Any) -> bytes:
    file = io.BytesIO()
    np.save(file, array, allow_pickle=True)
    return file.getvalue()


@pytest.mark.parametrize(
    ("data", "says"),
    [
        (b"", "damaged"),
        (archive(rest=b"\0" * (65 << 20)), "larger than 64 MiB"),
        (archive(**{f"a{n}": b"" for n in range(99)}), "99 arrays"),
        (archive(rest=header_of((10**12,))), "no array of numbers"),
        (archive(rest=header_of((10**6, 10**6))), "not as large as its header says"),
        (archive(rest=header_of((1,), b"1234")), "not as large as its header says"),
        (archive(rest=pickle_of(np.array([{}], object))), "no array of numbers"),
        (archive(rest=b"text"), "damaged"),
        (archive(rest=header_of((1,), b"12345678"))[:-30], "damaged"),
    ],
)
def test_arrays_that_are_none_take_no_memory_and_run_no_code(data: bytes, says: str) -> None:
    with pytest.raises(BadArrays, match=says):
        unpacked(data)


# ---- links, paths, pipes


LINKS = ["run.json", "journal.jsonl", "experience.jsonl", "report.html", "step-000.png", "video.mp4", "notes"]
LINKS += ["files/three_areas.nid", "state/002.npz", "state/009.npz", "files", "state"]


@pytest.mark.parametrize("name", LINKS)
def test_nothing_is_read_or_written_through_a_link(
    name: str, folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = folder / name
    target = tmp_path / "elsewhere"
    if path.exists():
        target = Path(shutil.move(path, tmp_path / "moved"))
    path.symlink_to(target)
    before = content(tmp_path)
    for words in (["report", str(folder)], resumed(folder), ["learn", "cleaning", str(folder)]):
        refused(words, folder, capsys, "E705", f"{name}` is not as a run leaves it: it is a link")
    assert content(tmp_path) == before


def test_a_link_that_leads_nowhere_is_no_place_for_a_video(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "video-2.mp4").symlink_to(tmp_path / "new")
    refused(resumed(folder), folder, capsys, "video-2.mp4` is not as a run leaves it: it is a link")
    assert not (tmp_path / "new").exists()


@pytest.mark.parametrize("copy", ["../elsewhere", "files/../../elsewhere", "/etc/hostname", "", "files/.."])
def test_texts_come_from_the_folder_alone(
    copy: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    sha = hashlib.sha256(ELSEWHERE.encode()).hexdigest()
    edited(folder, lambda header: header["files"][-1].update(copy=copy, sha256=sha))
    refused(resumed(folder), folder, capsys, "E705")


def test_a_file_with_another_name_is_not_appended_to(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    os.link(folder / "journal.jsonl", tmp_path / "backup")
    refused(resumed(folder), folder, capsys, "E705", "hard link")
    assert run(["report", str(folder)]) == 0, "only going on changes it"


@pytest.mark.parametrize("name", ["run.json", "journal.jsonl", "experience.jsonl", "state/002.npz"])
def test_a_pipe_keeps_nobody_waiting(name: str, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / name).unlink()
    os.mkfifo(folder / name)
    for words in (["report", str(folder)], resumed(folder)):
        refused(words, folder, capsys, "E705", "no regular file")


# ---- records


def test_a_newer_format_is_refused_with_a_sentence(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    edited(folder, lambda header: header.update(format=2, seed={"a": "later meaning"}))
    for words in (["report", str(folder)], resumed(folder)):
        refused(words, folder, capsys, "E705", "written in format 2", "reads formats up to 1")


HEADERS: dict[str, tuple[Callable[[dict[str, Any]], object], str]] = {
    "no format": (lambda h: h.pop("format"), "missing required field `format`"),
    "format 0": (lambda h: h.update(format=0), "there is no format 0"),
    "seed": (lambda h: h.update(seed="one"), "`$.seed`"),
    "sha": (lambda h: h["files"][1].update(sha256="x"), "`$.files[1].sha256`"),
    "options": (lambda h: h["options"].update(samples=[1]), "`$.options[...]`"),
    "seconds": (
        lambda h: h.update(episode={"reason": "", "clean": True, "actions": 0, "seconds": {"total": -1}}),
        "`$.episode.seconds[...]`",
    ),
    "truth": (lambda h: h.update(truth={"on_table": "all"}), "`$.truth.on_table`"),
}


@pytest.mark.parametrize("name", HEADERS)
def test_a_record_that_is_none_is_refused_with_its_field(
    name: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    change, says = HEADERS[name]
    edited(folder, change)
    for words in (["report", str(folder)], resumed(folder)):
        refused(words, folder, capsys, "E705", says)


OPTIONS = {
    "strategy": "guess",
    "planner": "oracle",
    "samples": 0,
    "objective": "fun",
    "known": -1,
    "job": "fly",
}


@pytest.mark.parametrize("name", OPTIONS)
def test_options_that_cannot_be_are_refused(
    name: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    edited(folder, lambda header: header["options"].update({name: OPTIONS[name]}))
    refused(resumed(folder), folder, capsys, "error[E705]: ")
    edited(folder, lambda header: header["options"].pop(name))
    refused(resumed(folder), folder, capsys, "error[E705]: ", name)


@pytest.mark.parametrize("more", [0, 3])
def test_the_lines_that_came_after_the_checkpoint_are_counted(more: int, folder: Path) -> None:
    """The run died right behind one, so that only those are dropped that are added here."""
    journal = folder / "journal.jsonl"
    lines = journal.read_bytes().splitlines(keepends=True)
    journal.write_bytes(b"".join(lines + lines[:more]))
    assert run(resumed(folder)) == 0
    (said,) = (record for record in read_journal(folder).records if isinstance(record, Resumed))
    assert (said.after, said.dropped) == (2, more)


def test_a_copy_that_is_no_text_is_refused_though_its_sum_is_right(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def sum_of(number: int, content: bytes) -> None:
        edited(folder, lambda h: h["files"][number].update(sha256=hashlib.sha256(content).hexdigest()))

    for number, file in enumerate(json.loads((folder / "run.json").read_text())["files"]):
        copy = folder / file["copy"]
        content = copy.read_bytes()
        copy.write_bytes(content + b"# \xff\n")
        refused(resumed(folder), folder, capsys, "error[E705]", copy.name, "is not the text any more")
        sum_of(number, copy.read_bytes())
        refused(resumed(folder), folder, capsys, "error[E705]", copy.name, "it is no UTF-8 text")
        copy.write_bytes(content)
        sum_of(number, content)


def test_a_mistake_in_run_json_is_shown_in_its_line(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    edited(folder, lambda header: header.update(seed=-3))
    text = (folder / "run.json").read_text()
    line = text[: text.index('"seed"')].count("\n") + 1
    refused(["report", str(folder)], folder, capsys, f"run.json:{line}:11: error[E705]", "^^")
    (folder / "run.json").write_text('{"format": 1,\n "seed" 3}')
    refused(["report", str(folder)], folder, capsys, "run.json:2:9: error[E705]")


@pytest.mark.parametrize(
    "text", ["[" * 100_000, '{"format":' + "[" * 100_000, '{"format": 1e999}', "", "\udcff"]
)
def test_what_is_no_json_is_refused(text: str, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "run.json").write_bytes(text.encode("utf-8", "surrogateescape"))
    refused(["report", str(folder)], folder, capsys, "E705")


@pytest.mark.parametrize("name", ["run.json", "journal.jsonl"])
@pytest.mark.parametrize("line", [1, 3])
def test_the_line_of_bytes_that_are_no_text_is_told(
    name: str, line: int, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    lines = (folder / name).read_bytes().split(b"\n")
    lines[line - 1] += b"\xff"
    (folder / name).write_bytes(b"\n".join(lines))
    refused(["report", str(folder)], folder, capsys, "error[E705]", name, f"no UTF-8 text (line {line})")


@pytest.mark.parametrize("name", ["run.json", "journal.jsonl"])
def test_absurd_sizes_are_refused_before_memory_is_used(
    name: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with (folder / name).open("r+b") as file:
        file.truncate(1 << 36)
    assert run(["report", str(folder)]) == 1
    assert ": it is larger than" in capsys.readouterr().err
    os.truncate(folder / name, 0)


def test_a_file_that_the_domain_includes_must_have_gone_in(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = 'domain d {\n  include "../elsewhere"\n}\n'
    (folder / "files" / "cleaning.nid").write_text(text)
    sha = hashlib.sha256(text.encode()).hexdigest()
    edited(folder, lambda header: header["files"][0].update(sha256=sha))
    refused(resumed(folder), folder, capsys, "not among the files that went into the run")


def test_a_scene_is_gone_on_with_by_the_calibration_that_went_in(
    folder: Path,
) -> None:
    """Also where the file that the scene names is another one, or somebody's secret."""
    scene = (
        'scene s {\n camera { calibration = "../elsewhere" }\n'
        " dirt { group { count = 3 at = (0, 0) radius = 3 cm } }\n}\n"
    )
    calibrated = as_text(Calibration("", Thresholds(contrast=0.0625), Appearance(1, 1, ((1, 1, 1),), 0.0)))
    files = folder / "files"
    (files / "s.nid").write_text(scene)
    sha = hashlib.sha256(scene.encode()).hexdigest()
    entry = {"path": "problems/s.nid", "sha256": sha, "copy": "files/s.nid"}
    edited(folder, lambda header: header["files"].__setitem__(-1, entry))
    with pytest.raises(Refused, match="the run holds no copy of it"):
        unfinished(folder)
    (files / "c.json").write_text(calibrated)
    sha = hashlib.sha256(calibrated.encode()).hexdigest()
    copy = {"path": "problems/../elsewhere", "sha256": sha, "copy": "files/c.json"}
    edited(folder, lambda header: header.update(calibration=copy))
    given: Any = unfinished(folder).inputs.given
    assert given.calibration.thresholds.contrast == 0.0625


# ---- what is removed, what is left


def test_only_our_own_temporary_files_are_removed(folder: Path) -> None:
    ours = [f"{where}.cleancli-0123456789abcdef.part" for where in ("", "state/")]
    others = [".gitignore", ".run.json.swp", ".cleancli-notes.part", ".cleancli-12.part", "state/.hidden"]
    others += ["step-abc.png", "step-1e9.png", "state/notes.npz", "files/.hidden"]
    for name in (*ours, *others):
        (folder / name).write_text("")
    (folder / ".cleancli-fedcba9876543210.part").mkdir()
    assert run(resumed(folder)) == 0
    assert [name for name in ours if (folder / name).exists()] == []
    assert [name for name in others if not (folder / name).exists()] == []
    assert (folder / ".cleancli-fedcba9876543210.part").is_dir()
    for name in ours:
        (folder / name).write_text("")
    assert run(resumed(folder)) == 2, "it has ended"
    assert [name for name in ours if (folder / name).exists()] == [], "its end may be what was being written"


def test_a_refused_run_leaves_no_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The planner first looks at the problem when the folder is there already."""
    monkeypatch.chdir(tmp_path)
    things = " ".join(f"a{number}" for number in range(20))
    facts = ", ".join(f"dirt(a{number})" for number in range(20))
    Path("d.nid").write_text(
        "domain d {\n  types { area }\n  predicates { dirt(?a - area) }\n  actions { wipe(?a - area) }\n"
        "  rule r: wipe(?a) { when dirt(?a) then 0.5: not dirt(?a) rest: nothing }\n"
        "  derived { left := count ?a - area: dirt(?a) }\n  reward { decrease(left) }\n}\n"
    )
    Path("p.nid").write_text(
        "problem p {\n  domain = d\n  horizon = 30\n"
        f"  objects {{ {things} - area }}\n  init {{ {facts} }}\n}}\n"
    )
    assert run(["check", "d.nid", "p.nid"]) == 0
    assert run(["execute", "d.nid", "p.nid", "--planner", "exact", "--quiet"]) == 1
    assert "E903" in capsys.readouterr().err
    assert not list(Path("runs").iterdir())


def test_nothing_from_a_file_steers_the_terminal(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    episode = {"reason": "\x1b[2J\x9b0m\x07", "clean": False, "actions": 0, "seconds": {"total": 0}}
    edited(folder, lambda h: h.update(episode=episode, options={"strategy": "\x1b]0;x\x07[/red]"}))
    assert run(resumed(folder)) == 2
    assert run(["report", str(folder)]) == 0
    edited(folder, lambda h: h.update(episode=None, versions={"cleancli": "\x1b[31m"}))
    assert run(resumed(folder)) == 2
    assert run(["report", str(folder), "--json"]) == 0
    edited(folder, lambda h: h.update(seed="\x1b[31m"))
    assert run(["report", str(folder)]) == 1
    told = "".join(capsys.readouterr())
    assert not {c for c in told if ord(c) < 32 or 127 <= ord(c) < 160} - {"\n"}
    assert r"\x1b[2J\u009b0m\x07" in told


def test_experience_of_a_run_is_learned_from_where_it_is_one(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["learn", "cleaning", str(folder)]) == 0
    (folder / "experience.jsonl").write_text(
        encode(Transition("fly", (), (), values_of(frozenset()), values_of(frozenset())), {}) + "\n"
    )
    refused(["learn", "cleaning", str(folder)], folder, capsys, "E701")


@pytest.mark.parametrize(
    "name", ["../elsewhere", "files/../../elsewhere", ".", "", "files/a\0b", "/etc/passwd"]
)
def test_no_name_leads_out_of_the_folder(folder: Path, name: str) -> None:
    with pytest.raises(Refused) as refused:
        read_inside(folder, name)
    (told,) = refused.value.diagnostics
    assert (told.code, "its path leaves the folder" in told.message) == ("E705", True)
