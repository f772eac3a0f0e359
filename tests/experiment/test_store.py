"""What is finished survives a kill, and nothing is trusted that is read."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from cleancli.experiment.episode import Finished
from cleancli.experiment.rows import CSV, PARQUET, read_rows, write_rows
from cleancli.experiment.store import LINES, Store, read_finished
from cleancli.language.diagnostics.refused import Refused
from support.studies import SYMBOLIC, opened, rows_here


@pytest.fixture(scope="module")
def finished() -> tuple[Finished, ...]:
    known: dict[str, Finished] = {}
    rows_here(opened(SYMBOLIC), known)
    return tuple(known.values())


def write(folder: Path, finished: tuple[Finished, ...]) -> None:
    with Store.opened(folder) as store:
        for each in finished:
            store.add(each)


def test_what_is_written_is_read_again(finished: tuple[Finished, ...], tmp_path: Path) -> None:
    write(tmp_path / "new", finished)
    assert read_finished(tmp_path / "new") == {each.row.key: each for each in finished}
    assert read_finished(tmp_path / "none") == {}


def test_a_line_that_a_kill_cut_short_counts_for_nothing(
    finished: tuple[Finished, ...], tmp_path: Path
) -> None:
    write(tmp_path, finished[:3])
    path = tmp_path / LINES
    whole = path.read_bytes()
    ends = [index + 1 for index, byte in enumerate(whole) if byte == ord("\n")]
    for cut in (0, 1, ends[0] - 1, ends[0], ends[0] + 7, ends[1], len(whole) - 1):
        path.write_bytes(whole[:cut])
        number = sum(end <= cut for end in ends)
        assert len(read_finished(tmp_path)) == number
        write(tmp_path, finished[number:3])
        assert path.read_bytes() == whole


def test_an_end_is_found_behind_a_long_line_that_was_cut_short(tmp_path: Path) -> None:
    (tmp_path / LINES).write_bytes(b"{}\n" + b"x" * 200_000)
    with Store.opened(tmp_path):
        pass
    assert (tmp_path / LINES).read_bytes() == b"{}\n"


@pytest.mark.parametrize(
    "line",
    [
        "",
        "{",
        "[" * 100_000,
        '{"row": 3}',
        '{"row": {"study": "s"}}',
        "\udcff",
        '{"row": null, "evidence": {"kinds": [], "order": [true]}}',
    ],
)
def test_a_line_that_is_none_is_told_with_its_place(
    finished: tuple[Finished, ...], tmp_path: Path, line: str
) -> None:
    write(tmp_path, finished[:1])
    with (tmp_path / LINES).open("ab") as file:
        file.write(line.encode(errors="surrogateescape") + b"\n")
    with pytest.raises(Refused) as refused:
        read_finished(tmp_path)
    (found,) = refused.value.diagnostics
    assert found.code == "E702"
    text = (tmp_path / LINES).read_text(encoding="utf-8", errors="replace")
    assert found.span is not None
    assert text.count("\n", 0, found.span.start) == 1


def test_rows_are_the_same_in_every_table(finished: tuple[Finished, ...], tmp_path: Path) -> None:
    rows = [each.row for each in finished]
    varied = [replace(row, axes={**row.axes, "rag.width": 0.12, "m": 3.0}) for row in rows[:2]]
    inked = [replace(rows[0], ink_left=0.25, score=0.75, axes={**rows[0].axes, "camera.at": "(0 m, 1 m)"})]
    for some in (rows, [*rows, *varied, *inked]):
        write_rows(tmp_path, some)
        assert list(read_rows(tmp_path / PARQUET)) == some
        lines = (tmp_path / CSV).read_text(encoding="utf-8").splitlines()
        assert len(lines) == len(some) + 1
        before = (tmp_path / PARQUET).read_bytes(), (tmp_path / CSV).read_bytes()
        write_rows(tmp_path, some)
        assert ((tmp_path / PARQUET).read_bytes(), (tmp_path / CSV).read_bytes()) == before


@pytest.mark.parametrize("content", [b"", b"PAR1", b"study,part\n", b"PAR1" + b"\0" * 100 + b"PAR1"])
def test_a_file_without_rows_is_told(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "rows.parquet"
    path.write_bytes(content)
    with pytest.raises(Refused, match="holds no rows of a study"):
        read_rows(path)


def test_a_table_of_other_things_is_told(tmp_path: Path) -> None:
    pyarrow = pytest.importorskip("pyarrow")
    from pyarrow import parquet

    parquet.write_table(pyarrow.table({"study": ["s"], "run": ["one"]}), tmp_path / "other.parquet")
    with pytest.raises(Refused, match="holds no rows of a study"):
        read_rows(tmp_path / "other.parquet")
