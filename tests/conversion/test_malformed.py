"""Files that are malformed, or say what cannot be said: each mistake has a place, and nothing is written."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from cleancli.cli.main import run

KITCHEN = Path(__file__).parent / "kitchen"
FILES = ("rules.dat", "state.dat", "symbols.dat")

MALFORMED = {
    # name: (file, what stands there, what it becomes, code and place, words of the message)
    "no colon": (
        "rules.dat",
        "CONTEXT:\n  dirt",
        "CONTEXT\n  dirt",
        "rules.dat:13:3: error[E911]",
        "expected `:`",
    ),
    "words before the first rule": (
        "rules.dat",
        "#rules = 9\n",
        "#rules = 9\nversion 2\n",
        "rules.dat:2:1: error[E911]",
        "expected `ACTION:`",
    ),
    "no context": ("rules.dat", "CONTEXT:\n  -running()\n", "", "rules.dat:48:1: error[E911]", "`CONTEXT:`"),
    "no outcomes": (
        "rules.dat",
        "OUTCOMES:\n  1.0 <no-change>\n",
        "",
        "rules.dat:44:1: error[E911]",
        "`OUTCOMES:`, but the rule ends",
    ),
    "open parenthesis": ("rules.dat", "0.1 wet(X)", "0.1 wet(X", "rules.dat:17:3: error[E911]", "expected"),
    "letters for a number": (
        "rules.dat",
        "0.8 -dirt",
        "O.8 -dirt",
        "rules.dat:15:3: error[E911]",
        "probability",
    ),
    "no probability": (
        "rules.dat",
        "  0.8 -dirt(X)",
        "  -dirt(X)",
        "rules.dat:15:3: error[E911]",
        "probability",
    ),
    "no effects": ("rules.dat", "0.1 wet(X)\n", "0.1\n", "rules.dat:17:3: error[E911]", "effects"),
    "wrong result": (
        "rules.dat",
        "<noise>\n\nACTION:\n  wash",
        "<nose>\n\nACTION:\n  wash",
        "rules.dat:8:7",
        "<nose>",
    ),
    "strange sign": (
        "rules.dat",
        "lightSoil(X) running()",
        "lightSoil(X) & running()",
        "rules.dat:13:24",
        "`&`",
    ),
    "wrong number of rules": (
        "rules.dat",
        "#rules = 9",
        "#rules = 8",
        "rules.dat:1:10: error[E911]",
        "has 9",
    ),
    "cut off": ("rules.dat", "\n  1 -running()\n", "", "rules.dat:74:10: error[E911]", "the rule ends"),
    "no rules": ("rules.dat", None, "", "rules.dat:1:1: error[E911]", "`ACTION:`"),
    "undeclared": (
        "rules.dat",
        "wet(X)\n  0.1 <no",
        "wett(X)\n  0.1 <no",
        "rules.dat:16:7: error[E912]",
        "`wet`",
    ),
    "arity": (
        "rules.dat",
        "stack(X Y)\nCONTEXT:\n  on(X Z) -d",
        "stack(X)\nCONTEXT:\n  on(X Z) -d",
        "rules.dat:31:3: error[E912]",
        "2 arguments",
    ),
    "no action": (
        "rules.dat",
        "switchOn()\nCONTEXT:\n  -",
        "running()\nCONTEXT:\n  -",
        "rules.dat:47:3: error[E912]",
        "no action",
    ),
    "action as effect": (
        "rules.dat",
        "0.5 wet(7)",
        "0.5 wash(7)",
        "rules.dat:59:7: error[E912]",
        "an action",
    ),
    "value of a predicate": (
        "rules.dat",
        "0.5 wet(7)",
        "0.5 wet(7)=1",
        "rules.dat:59:7: error[E912]",
        "true or false",
    ),
    "no value": ("rules.dat", "water(7)<1", "water(7)", "rules.dat:65:11: error[E912]", "number"),
    "derived": (
        "rules.dat",
        "sink(X) water",
        "above(X X) water",
        "rules.dat:65:3: error[E913]",
        "follows from",
    ),
    "count asked for": (
        "rules.dat",
        "sink(X) water",
        "wetThings()=1 water",
        "rules.dat:65:3: error[E913]",
        "follows",
    ),
    "unbound": ("rules.dat", "0.1 wet(X)", "0.1 wet(Y)", "rules.dat:16:7: error[E913]", "binds `Y`"),
    "set to no value": ("rules.dat", "water(7)=2", "water(7)>2", "rules.dat:51:17: error[E913]", "no value"),
    "set twice": (
        "rules.dat",
        "running() water(7)=2",
        "water(7)=1 water(7)=2",
        "rules.dat:51:18",
        "two values",
    ),
    "default with effects": (
        "rules.dat",
        "0.6 <no-change>",
        "0.6 wet(1)",
        "rules.dat:7:7: error[E913]",
        "default",
    ),
    "default that is not all": (
        "rules.dat",
        "0.6 <no-change>",
        "0.5 <no-change>",
        "rules.dat:7:3: error[E914]",
        "sum to 0.9",
    ),
    "too much": ("rules.dat", "0.8 -dirt(X)", "0.9 -dirt(X)", "rules.dat:15:3: error[E914]", "sum to 1.1"),
    "percent": (
        "rules.dat",
        "1.0 <no-change>",
        "100 <no-change>",
        "rules.dat:44:3: error[E914]",
        "at most 1",
    ),
    "huge number": ("rules.dat", "1.0 <no", "1e999999999 <no", "rules.dat:44:7: error[E911]", "expected"),
    "arity with a point": ("symbols.dat", "stack 2", "stack 2.5", "symbols.dat:2:7: error[E911]", "2.5"),
    "no arity": (
        "symbols.dat",
        "stack 2",
        "stack",
        "symbols.dat:2:7: error[E911]",
        "number of its arguments",
    ),
    "count of nothing": ("symbols.dat", "Num X wet(X)", "Num X", "symbols.dat:15:37: error[E911]", "literal"),
    "count without arrow": (
        "symbols.dat",
        "<-- Num",
        "Num",
        "symbols.dat:15:28: error[E911]",
        "what is counted",
    ),
    "count for each": (
        "symbols.dat",
        "wetThings 0",
        "wetThings 1",
        "symbols.dat:15:1: error[E913]",
        "each object",
    ),
    "declared twice": ("symbols.dat", "sink 1", "dirt 1", "symbols.dat:10:1: error[E912]", "second time"),
    "rest of a line": (
        "symbols.dat",
        "sink 1 primitive binary",
        "sink 1 primitive binary 3",
        "symbols.dat:10:25",
        "end",
    ),
    "variable in the state": ("state.dat", "sink(7)", "sink(X)", "state.dat:1:1: error[E912]", "`X`"),
    "state with a number": ("state.dat", "wet(3)", "wet(3) 7", "state.dat:1:71: error[E911]", "a literal"),
    "fact of what is not": ("state.dat", "wet(3)", "wets(3)", "state.dat:1:64: error[E912]", "did you mean"),
    "two values": ("state.dat", "water(1)=0", "water(7)=0", "state.dat:2:", "two values"),
    "missing value": ("state.dat", "water(1)=0", "", "symbols.dat:12:1: error[E913]", "water(1)"),
    "a comparison in the state": (
        "state.dat",
        "water(1)=0",
        "water(1)<1",
        "state.dat:2:63: error[E912]",
        "a state gives `water` a value",
    ),
    "default with arguments": (
        "rules.dat",
        "default()",
        "default(X)",
        "rules.dat:3:3: error[E913]",
        "no arguments",
    ),
    "action with a value": (
        "rules.dat",
        "wash(X)\n",
        "wash(X)=1\n",
        "rules.dat:11:3: error[E911]",
        "an action",
    ),
    "not a text": ("state.dat", "sink", "\0sink", "E004", "UTF-8"),
}


@pytest.mark.parametrize("name", MALFORMED)
def test_each_mistake_is_located(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file, old, new, place, words = MALFORMED[name]
    for each in FILES:
        text = (KITCHEN / each).read_text(encoding="utf-8")
        if each == file:
            assert old is None or text.count(old) >= 1, "the mistake is not in the text"
            text = new if old is None else text.replace(old, new, 1)
        (tmp_path / each).write_text(text, encoding="utf-8")
    assert run(["convert", str(tmp_path), "--out", str(tmp_path / "out")]) == 1
    captured = capsys.readouterr()
    assert re.search(rf"{re.escape(place)}\b", captured.err) or place in captured.err, captured.err
    assert words in captured.err
    assert "Traceback" not in captured.err
    assert captured.out == ""
    assert not (tmp_path / "out").exists()


def test_mistakes_of_all_rules_and_lines_are_told_at_once(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for each in FILES:
        text = (KITCHEN / each).read_text(encoding="utf-8")
        text = text.replace("OUTCOMES:\n", "OUTCOMES\n").replace(" binary", "").replace("sink(7)", "sink(7")
        (tmp_path / each).write_text(text, encoding="utf-8")
    assert run(["convert", str(tmp_path), "--out", str(tmp_path / "out")]) == 1
    assert capsys.readouterr().err.count("error[E911]") == 9 + 13 + 1


def test_missing_files_are_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["convert", str(tmp_path), "--out", str(tmp_path / "out")]) == 1
    assert "rules.dat" in capsys.readouterr().err
