"""Lines of experience that are JSON, and not what docs/runs.md says: each is a located mistake, no crash."""

from __future__ import annotations

import io
import json

import pytest

from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.load import load_domain
from cleancli.learning.experience import Transition, decode

DOMAIN = load_domain(
    Source(
        "tidy.nid",
        """domain tidy {
  types { box }  predicates { dirty(?b - box) }  functions { load(?b - box): 0..3 }
  derived { left := count ?b - box: dirty(?b) }  actions { wipe(?b - box) }
  rule wiped: wipe(?b) { when dirty(?b) then 0.5: not dirty(?b) rest: nothing }
  reward { decrease(left) }
}""",
    )
)
GOOD = {
    "action": "wipe",
    "arguments": ["b1"],
    "objects": {"b1": "box"},
    "before": [["dirty", ["b1"], True], ["load", ["b1"], 1]],
    "after": [["load", ["b1"], 1]],
}
SIMPLE: tuple[object, ...] = (None, True, 3, 1.5, "b1")
ODD = (*SIMPLE, [], {}, [3], [None], [["b1"]], [{"b1": 1}], {"b1": 3}, {"3": ["box"]})


def read(text: str) -> tuple[Transition, ...]:
    return tuple(decode(io.BytesIO(text.encode()), "x.jsonl", DOMAIN))


def refusals(line: object) -> list[str]:
    text = json.dumps(GOOD) + "\n" + json.dumps(line) + "\n"
    try:
        read(text)
    except Refused as refused:
        return [diagnostic.code for diagnostic in refused.diagnostics]
    return []


def test_the_line_that_is_changed_is_right() -> None:
    assert refusals(GOOD) == []


@pytest.mark.parametrize("key", GOOD)
@pytest.mark.parametrize("value", ODD, ids=json.dumps)
def test_a_part_of_another_kind_is_a_mistake(key: str, value: object) -> None:
    if value == [] and key in ("before", "after"):
        pytest.skip("a state may list no facts")
    assert refusals({**GOOD, key: value}) == ["E701"]


@pytest.mark.parametrize("name", [3, None, True, ["b1"], {"b1": 1}], ids=json.dumps)
@pytest.mark.parametrize("place", ["arguments", "fact", "symbol", "action"])
def test_names_are_strings(name: object, place: str) -> None:
    changes: dict[str, dict[str, object]] = {
        "arguments": {"arguments": [name]},
        "fact": {"before": [["dirty", [name], True]]},
        "symbol": {"before": [[name, ["b1"], True]]},
        "action": {"action": name},
    }
    assert refusals({**GOOD, **changes[place]}) == ["E701"]


@pytest.mark.parametrize("value", [4, -1, 1.0, "1", True, None, [1]], ids=json.dumps)
def test_a_value_is_one_that_is_declared(value: object) -> None:
    assert refusals({**GOOD, "before": [["load", ["b1"], value]]}) == ["E701"]
    assert refusals({**GOOD, "before": [["dirty", ["b1"], 1]]}) == ["E701"]


@pytest.mark.parametrize("entry", [["dirty", [], True], ["dirty", ["b1", "b1"], True], ["left", [], 1]])
def test_a_symbol_is_declared_for_so_many_objects(entry: object) -> None:
    assert refusals({**GOOD, "before": [*GOOD["before"], entry]}) == ["E701"]


@pytest.mark.parametrize("line", ["[" * 200_000, '{"action": ' + "[" * 200_000, "", "null", "{", '"wipe"'])
def test_a_line_that_is_no_object_is_a_mistake(line: str) -> None:
    text = f"{json.dumps(GOOD)}\n{line}\n{json.dumps(GOOD)}\n"
    if not line:
        assert len(read(text)) == 2
        return
    with pytest.raises(Refused) as refused:
        read(text)
    assert [diagnostic.code for diagnostic in refused.value.diagnostics] == ["E701"]
