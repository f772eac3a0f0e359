"""What client and driver say: the examples of docs/protocol.md, and records there and back."""

from __future__ import annotations

import json
import re
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cleancli.motion.path import Dustpan, Interpolation, ToolPath, Waypoint
from cleancli.remote import messages
from cleancli.remote.fields import Fields, fields_of
from cleancli.remote.messages import Poll, State
from cleancli.remote.wire import Array, BadMessage, Message, encoded, received
from cleancli.world.robot import Status
from support.toy_driver import TOY, Toy

PAGE = Path(__file__).parents[2] / "docs" / "protocol.md"
STATE = State(1.5, (0.1, -0.2, 0.05), "")
FINITE = st.floats(-1e8, 1e8)
WAYPOINT = st.builds(Waypoint, FINITE, FINITE, FINITE, FINITE, st.floats(1e-3, 1e3))
PATHS = st.builds(
    ToolPath,
    st.lists(WAYPOINT, min_size=1, max_size=5).map(tuple),
    st.sampled_from(Interpolation),
    st.none() | st.builds(Dustpan, WAYPOINT, WAYPOINT, FINITE),
)


def sent(message: Message) -> Fields:
    """What comes of a message on the other side."""
    left = memoryview(b"".join(map(bytes, encoded(message))))

    def fill(memory: memoryview) -> None:
        nonlocal left
        memory[:], left = left[: len(memory)], left[len(memory) :]

    return fields_of(received(fill))


def examples() -> list[dict[str, Any]]:
    return [json.loads(text) for text in re.findall(r"```json\n(.*?)```", PAGE.read_text(), re.DOTALL)]


def test_the_examples_of_the_page_are_messages() -> None:
    state, hello, frames = examples()
    assert messages.state_of(Fields(state)) == State(12.25, (0.1, -0.2, 0.05), "")
    said = Fields(hello)
    described = messages.description_of(said)
    assert (described.robot, described.limits.depth) == ("ur5e in the kitchen lab", 0.005)
    assert messages.state_of(said).tool == (0.0, 0.4, 0.2)
    said.end()
    del frames["arrays"]
    pictures: dict[str, Array] = {
        "colour": np.zeros((480, 640, 3), np.uint8),
        "depth": np.zeros((480, 640), np.float32),
    }
    said = Fields(frames, pictures)
    pair = messages.frames_of(said)
    assert messages.state_of(said).clock == 12.25
    said.end()
    assert pair.distortion == "plumb_bob"
    assert pair.pose[2].tolist() == [0, 0, -1, 0.9]


def test_requests_and_replies_of_the_page_are_all_there_are() -> None:
    text = PAGE.read_text()
    table = text.partition("## Requests and replies")[2].partition("**`hello`**")[0]
    assert re.findall(r"^\| `(\w+)` \|", table, re.MULTILINE) == [
        *("hello", "state", "observe", "can_follow", "start", "withdraw", "poll", "stop", "rearm")
    ]


@settings(deadline=None)
@given(PATHS)
def test_paths_come_as_they_were(path: ToolPath) -> None:
    said = sent(messages.path_request("start", path))
    assert said.text("request") == "start"
    assert messages.path_of(said) == path
    said.end()


def test_replies_come_as_they_were() -> None:
    said = sent(messages.reply(STATE, **messages.described(TOY)))
    assert messages.description_of(said) == TOY
    assert messages.state_of(said) == STATE
    said.end()
    pair = Toy().observe()
    said = sent(messages.frames_reply(pair, STATE))
    again = messages.frames_of(said)
    assert messages.state_of(said) == STATE
    said.end()
    np.testing.assert_array_equal(again.colour, pair.colour)
    np.testing.assert_array_equal(again.depth, pair.depth)
    np.testing.assert_array_equal(again.pose, pair.pose)
    assert (again.colour_stamp, again.focal, again.centre) == (pair.colour_stamp, pair.focal, pair.centre)
    poll = Poll(Status.FAILED, "something holds the tool back")
    said = sent(messages.poll_reply(poll, STATE))
    assert messages.poll_of(said) == poll


def test_what_a_driver_says_of_its_failures_is_one_line() -> None:
    said = sent(messages.error("no\nway \x1b[31m\ud800" + "!" * 2000))
    text = said.text("error")
    assert text.startswith("no?way ?[31m?!")
    assert len(text) == 1000


def start(**changed: object) -> tuple[dict[str, object], dict[str, np.ndarray[Any, Any]]]:
    head = {"interpolation": "straight"} | changed
    waypoints = head.pop("waypoints", np.full((2, 5), 0.1))
    return head, {"waypoints": waypoints}  # type: ignore[dict-item]


@pytest.mark.parametrize(
    ("changed", "reason"),
    [
        ({"interpolation": "curved"}, "`interpolation` is neither"),
        ({"interpolation": None}, "`interpolation` is no line"),
        ({"waypoints": np.zeros((0, 5))}, "1 to 10000 waypoints"),
        ({"waypoints": np.zeros((2, 5), np.float32)}, "float32 of 2 x 5, and not float64 of any x 5"),
        ({"waypoints": np.ones((2, 4))}, "not float64 of any x 5"),
        ({"waypoints": np.zeros((1, 5))}, "its speed is above 0"),
        ({"waypoints": np.full((1, 5), np.nan)}, "finite"),
        ({"waypoints": np.full((1, 5), np.inf)}, "finite"),
        ({"dustpan": {}}, "`place` is missing"),
        ({"dustpan": 3}, "`dustpan` is no object"),
    ],
)
def test_what_is_no_path_is_refused(changed: dict[str, object], reason: str) -> None:
    with pytest.raises(BadMessage, match=reason):
        messages.path_of(Fields(*start(**changed)))


HELLO = messages.described(TOY) | {"skills": ["straight"]}
LIMITS = {"low": [0, 0, 0], "high": [1, 1, 1], "speed": 1, "depth": 0}


@pytest.mark.parametrize(
    ("changed", "reason"),
    [
        ({"version": 2}, "speaks version 2"),
        ({"version": 1.0}, "`version` is no whole number"),
        ({"robot": "a\nb"}, "`robot` is no line"),
        ({"skills": ["flying"]}, "`skills` names `flying`"),
        ({"skills": [1]}, "`skills` is no line"),
        ({"lease": 0}, "`lease` is not above 0"),
        ({"period": True}, "`period` is no number"),
        ({"limits": LIMITS | {"low": [0, 0]}}, "`low` is no list of 3 numbers"),
        ({"limits": LIMITS | {"low": [0, 0, 1]}}, "`low` below `high`"),
        ({"limits": LIMITS | {"depth": -1}}, "a depth from 0"),
        ({"limits": LIMITS | {"speed": 1e10}}, "`speed` is no number up to"),
        ({"limits": LIMITS | {"force": 1}}, "there is no key `force`"),
    ],
)
def test_what_describes_no_robot_is_refused(changed: dict[str, object], reason: str) -> None:
    with pytest.raises(BadMessage, match=reason):
        messages.description_of(Fields({**HELLO, "limits": LIMITS} | changed))


def test_what_is_no_pair_is_refused() -> None:
    good = messages.frames_reply(Toy().observe(), STATE)
    shapes: list[tuple[dict[str, Array], str]] = [
        ({"colour": np.zeros((6, 8, 4), np.uint8)}, "`colour` is uint8 of 6 x 8 x 4"),
        ({"depth": np.zeros((5, 8), np.float32)}, "`depth` is float32 of 5 x 8, and not float32 of 6 x 8"),
        ({"depth": np.zeros((6, 8))}, "`depth` is float64"),
        ({"colour": np.zeros((0, 8, 3), np.uint8), "depth": np.zeros((0, 8), np.float32)}, "no pixels"),
    ]
    for arrays, reason in shapes:
        with pytest.raises(BadMessage, match=reason):
            messages.frames_of(Fields(good.head, {**good.arrays, **arrays}))
    with pytest.raises(BadMessage, match="the array `depth` is missing"):
        messages.frames_of(Fields(good.head, {"colour": good.arrays["colour"]}))


@pytest.mark.parametrize(
    ("colour", "depth", "wrong"),
    [
        (1.0, 1.0, None),
        (1.2, 1.2, None),
        (1.1, 1.15, None),
        (1.1, 1.151, "unpaired"),
        (1.151, 1.1, "unpaired"),
        (0.999, 1.0, "stamp-past"),
        (1.0, 0.999, "stamp-past"),
        (1.2, 1.201, "stamp-future"),
        (1.201, 1.2, "stamp-future"),
    ],
)
def test_pairs_are_taken_when_they_are_asked_for(colour: float, depth: float, wrong: str | None) -> None:
    pair = replace(Toy().observe(), colour_stamp=colour, depth_stamp=depth)
    found = messages.mistimed(pair, 1.0, 1.2)
    assert (None if found is None else found[0]) == wrong


@settings(deadline=None, max_examples=200)
@given(
    st.dictionaries(st.sampled_from([*HELLO, "state", "status", "failure", "refused", "camera"]), st.data())
)
def test_any_head_is_read_or_refused(drawn: dict[str, st.DataObject]) -> None:
    values: st.SearchStrategy[object] = (
        st.none() | st.booleans() | FINITE | st.text() | st.lists(FINITE) | st.just({}) | st.just(LIMITS)
    )
    head = {key: each.draw(values) for key, each in drawn.items()}
    for read in (messages.description_of, messages.state_of, messages.poll_of, messages.frames_of):
        with suppress(BadMessage):
            read(Fields(head))
