"""One small file for each construct: it reads as the model beside it, which reads as itself.

CLEANCLI_REGENERATE=1 rewrites the expected models; read the difference before keeping it.
"""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.load import (
    checked_domain,
    domain_named,
    kind_of,
    load_domain,
    load_problem,
    read_source,
)
from cleancli.language.printing.printer import print_domain, print_problem

FOLDER = Path(__file__).parent / "constructs"


def _printed(path: Path) -> str:
    source = read_source(path)
    if kind_of(source) == "domain":
        domain = load_domain(source)
        text = print_domain(domain)
        assert load_domain(Source("printed", text)) == domain
        return text
    of = load_domain(read_source(FOLDER / f"{domain_named(source).text}.nid"))
    problem = load_problem(source, of)
    text = print_problem(problem, of)
    assert load_problem(Source("printed", text), of) == problem
    return text


@pytest.mark.parametrize("path", sorted(FOLDER.glob("*.nid")), ids=lambda path: path.stem)
def test_construct(path: Path) -> None:
    expected = path.with_suffix(".txt")
    if os.environ.get("CLEANCLI_REGENERATE"):
        expected.write_text(_printed(path), encoding="utf-8")
    assert _printed(path) == expected.read_text(encoding="utf-8")


def test_included_spans_lie_in_their_own_file() -> None:
    checked = checked_domain(read_source(FOLDER / "include.nid"))
    names = [Path(source.path).name for source in checked.sources]
    assert names == ["include.nid", "more.nid", "base.nid"]
    span = checked.get().default[0].probability_span
    assert span is not None
    text = {source.path: source.text for source in checked.sources}[span.path]
    assert Path(span.path).name == "base.nid"
    assert text[span.start : span.end] == "1"


def test_an_include_may_leave_the_folder_where_that_is_allowed(tmp_path: Path) -> None:
    (tmp_path / "inner").mkdir()
    (tmp_path / "base.nid").write_text("domain b { types { area } predicates { dirt(?a - area) } }")
    top = tmp_path / "inner" / "top.nid"
    top.write_text(
        'domain d { include "../base.nid" derived { n := count ?a - area: dirt(?a) } reward { decrease(n) } }'
    )
    assert [d.code for d in checked_domain(read_source(top)).diagnostics] == ["E109"]
    assert checked_domain(read_source(top), allow_outside=True).get().types[0].name == "area"


def test_the_size_limit_is_for_all_files_together(tmp_path: Path) -> None:
    filler = "# " + "x" * 3 * 1024 * 1024
    for name in ("a", "b", "c"):
        (tmp_path / f"{name}.nid").write_text(f"domain {name} {{ }}\n{filler}")
    includes = "".join(f'include "{name}.nid"\n' for name in ("a", "b", "c"))
    source = Source(str(tmp_path / "top.nid"), f"domain d {{ {includes} reward {{ cost }} }}")
    assert [d.code for d in checked_domain(source).diagnostics] == ["E005"]
