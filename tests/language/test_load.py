"""Files that cannot be read, and what checked models hold."""

from __future__ import annotations

import io
import subprocess
import sys
from fractions import Fraction
from pathlib import Path

import pytest

from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.find import find
from cleancli.language.load import (
    checked_domain,
    domain_named,
    load_domain,
    load_problem,
    read_source,
    read_stream,
)
from cleancli.language.model import Fact, Horizon, OutcomeKind, RewardKind, RewardTerm
from cleancli.language.parsing import read
from cleancli.resources import shipped_names
from cleancli.scene.check import load_scene
from cleancli.scene.grasps import WIDE
from cleancli.scene.model import Rag

HERE = Path(__file__).parent


def _code(action: object, *arguments: object) -> str:
    with pytest.raises(Refused) as refused:
        action(*arguments)  # type: ignore[operator]
    return refused.value.diagnostics[0].code


def test_unreadable_files(tmp_path: Path) -> None:
    large = tmp_path / "large.nid"
    with large.open("wb") as file:
        file.truncate(8 * 1024 * 1024 + 1)
    assert _code(read_source, tmp_path / "none.nid") == "E001"
    assert _code(read_source, tmp_path) == "E002"
    assert _code(read_source, "a\0b") == "E003"
    assert _code(read_source, large) == "E005"


def test_line_ends_are_kept(tmp_path: Path) -> None:
    path = tmp_path / "a.nid"
    path.write_bytes(b"domain d {\r\n}\r")
    assert read_source(path).text == "domain d {\r\n}\r"


def test_a_shipped_file_is_found_by_its_name_a_path_first(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert find("cleaning", "domains").name == find("cleaning.nid", "domains").name == "cleaning.nid"
    assert "two_groups" in shipped_names("problems")
    (tmp_path / "cleaning").mkdir()
    assert find("cleaning", "domains").is_file(), "a folder does not hide a shipped file"
    (tmp_path / "cleaning").rmdir()
    (tmp_path / "cleaning").write_text("")
    assert find("cleaning", "domains") == Path("cleaning")
    with pytest.raises(Refused) as refused:
        find("two_group", "problems")
    assert "did you mean `two_groups`" in refused.value.diagnostics[0].help


def test_the_small_domain() -> None:
    domain = load_domain(read_source(HERE / "small.nid"))
    small, larger = domain.rules
    assert [o.probability for o in small.outcomes] == [Fraction(8, 10), Fraction(1, 10), Fraction(1, 10)]
    assert [o.is_rest for o in small.outcomes] == [False, False, True]
    assert small.outcomes[2].kind is OutcomeKind.NOISE
    assert larger.outcomes[0].probability == Fraction(1, 3)
    assert domain.actions[0].duration == 9.0
    assert domain.actions[1].duration is None
    assert domain.reward == (RewardTerm(Fraction(1), RewardKind.DECREASE, "dirty"),)


def test_facts_are_canonical_and_commas_optional() -> None:
    domain = load_domain(read_source(HERE / "small.nid"))
    text = """problem p { domain = small objects { b a - area }
      init { near(b, a) near(a, b), size(a) = big size(b) = small, } horizon = 2 + dirty }"""
    problem = load_problem(Source("p", text), domain)
    assert problem.state == {
        Fact("near", ("a", "b")),
        Fact("size", ("a",), "big"),
        Fact("size", ("b",), "small"),
    }
    assert problem.horizon == Horizon(2, "dirty")
    assert problem.discount == 0.95


def test_a_scene_needs_dirt_only_and_defaults_are_those_of_two_groups() -> None:
    short = load_scene(Source("s", "scene s { dirt { group { count = 1 at = (0 m, 0 m) radius = 1 cm } } }"))
    full = load_scene(read_source(find("two_groups", "problems")))
    assert (short.surface, short.container, short.rag) == (full.surface, full.container, full.rag)
    assert (short.camera, short.symbols, short.domain) == (full.camera, full.symbols, full.domain)
    assert full.rag == Rag(WIDE, 0.12)


def test_the_domain_of_a_file() -> None:
    assert domain_named(read_source(find("three_areas", "problems"))).text == "cleaning"
    assert _code(domain_named, Source("p", "problem p { }")) == "E407"
    assert _code(load_scene, read_source(HERE / "small.nid")) == "E106"


def test_checking_loads_no_heavy_library() -> None:
    program = (
        "import sys; from cleancli.language.load import *; "
        f"load_domain(read_source({str(HERE / 'small.nid')!r})); "
        "print([m for m in ('numpy', 'numba', 'cv2', 'pybullet', 'scipy') if m in sys.modules])"
    )
    assert subprocess.check_output([sys.executable, "-c", program], text=True).strip() == "[]"


CHAIN = """domain chain {
  types { bead }
  predicates { strung(?a ?b - bead) [static]  shut(?a - bead) }
  derived { along(?a ?b - bead) := closure strung  left := count ?a - bead: not shut(?a) }
  actions { close(?a - bead) }
  rule closed: close(?a) { when not shut(?a), exists ?b - bead: along(?a, ?b) then 1: shut(?a) }
  reward { decrease(left) }
}"""


def test_what_a_closure_is_of_is_used() -> None:
    assert checked_domain(Source("chain.nid", CHAIN)).diagnostics == ()
    unused = CHAIN.replace("closure strung", "not shut(?a), not shut(?b)")
    assert "W201" in [d.code for d in checked_domain(Source("chain.nid", unused)).diagnostics]


def test_an_effect_that_a_condition_says_already_is_idle_but_for_libprada() -> None:
    """libPRADA takes the condition and what is set as independent, so there all that is set counts."""
    idle = CHAIN.replace("1: shut(?a)", "1: shut(?a), strung(?a, ?a)").replace(" [static]", "")
    idle = idle.replace("not shut(?a), exists", "not shut(?a), strung(?a, ?a), exists")
    for compat, expected in ((False, ["W301"]), (True, [])):
        found = checked_domain(Source("chain.nid", idle), compat=compat)
        assert [diagnostic.code for diagnostic in found.diagnostics] == expected


def test_values_that_are_missing_are_counted_and_not_listed() -> None:
    """A function of 40 objects has more values than any memory holds."""
    parameters = " ".join(f"?x{n}" for n in range(40))
    domain = load_domain(
        Source(
            "d.nid",
            f"domain d {{ types {{ t }} functions {{ f({parameters} - t): 0..3 }} reward {{ goal }} }}",
        )
    )
    given = ", ".join(["a"] * 40)
    stated = f"objects {{ a b - t }} init {{ f({given}) = 1 }} goal {{ f({given}) = 2 }}"
    text = f"problem p {{ domain = d horizon = 3 {stated} }}"
    with pytest.raises(Refused) as refused:
        load_problem(Source("p.nid", text), domain)
    (wrong,) = refused.value.diagnostics
    assert wrong.code == "E404"
    assert wrong.message.endswith(f" and {2**40 - 4} more have no value")


def test_the_wrong_kind_is_marked_where_it_stands_and_not_in_a_comment_before() -> None:
    source = Source("p.nid", "# a problem of mine\nproblem p { domain = d }\n")
    with pytest.raises(Refused) as error:
        load_domain(source)
    (found,) = error.value.diagnostics
    assert found.code == "E106"
    assert found.span is not None
    assert found.span.start == source.text.index("\nproblem") + 1


def test_a_stream_is_read_whole_or_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(read, "LARGEST", 10)
    assert read_stream(io.BytesIO(b"x" * 10), "<stdin>").text == "x" * 10
    assert _code(read_stream, io.BytesIO(b"x" * 11), "<stdin>") == "E005"
