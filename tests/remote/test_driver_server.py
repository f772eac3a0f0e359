"""A driver at its port: who may ask what, what comes of nonsense, and what becomes of a client that goes."""

from __future__ import annotations

import socket
import struct
import time
from collections.abc import Iterator
from contextlib import closing, suppress
from dataclasses import replace
from threading import Thread

import numpy as np
import pytest

from cleancli.remote.client import Broken, Client, Refusal
from cleancli.remote.messages import FramePair, State, described, reply
from cleancli.remote.server import MOST_CLIENTS, Server
from cleancli.remote.wire import Message, encoded
from cleancli.scene.address import Address, address_of
from cleancli.world.errors import RobotError
from cleancli.world.robot import Status
from support.toy_driver import ANYWHERE, TOY, Toy, path, served

ACROSS = path((-0.4, 0.0, 0.05), (-0.4, 0.0, 0.0), (0.4, 0.0, 0.0), (0.4, 0.0, 0.05))


@pytest.fixture
def toy() -> Toy:
    return Toy()


@pytest.fixture
def server(toy: Toy) -> Iterator[Server]:
    with served(toy) as server:
        yield server


@pytest.fixture
def client(server: Server) -> Iterator[Client]:
    with Client(server.address) as client:
        yield client


def begun(client: Client) -> int:
    motion = client.start(ACROSS)
    assert isinstance(motion, int), motion
    return motion


def test_a_client_is_told_who_the_robot_is(client: Client, toy: Toy) -> None:
    assert client.description == TOY
    assert client.state.tool == toy.tool


def test_pictures_come_as_they_were_taken(client: Client, toy: Toy) -> None:
    before = client.state.clock
    pair, same = client.observe(), Toy().observe()
    np.testing.assert_array_equal(pair.colour, same.colour)
    np.testing.assert_array_equal(pair.depth, same.depth)
    assert before <= pair.colour_stamp <= client.state.clock


def test_a_motion_goes_on_while_it_is_polled(client: Client, toy: Toy) -> None:
    assert client.can_follow(ACROSS, 2.0)
    motion = client.start(path((0.0, 0.3, 0.1)))
    assert isinstance(motion, int)
    clocks = [client.state.clock]
    while client.poll(motion).status is Status.RUNNING:
        clocks.append(client.state.clock)
    assert clocks == sorted(clocks)
    assert len(clocks) > 10
    assert client.state.tool == pytest.approx((0.0, 0.3, 0.1))


def test_what_is_beyond_the_limits_is_refused_before_anything_moves(client: Client, toy: Toy) -> None:
    far = path((0.0, 0.0, 0.05), (0.501, 0.0, 0.05))
    assert not client.can_follow(far, 0.0)
    refused = client.start(far)
    assert isinstance(refused, Refusal)
    assert "1.00 mm outside" in refused.reason
    time.sleep(0.02)
    assert toy.tool == client.state.tool


def test_stopping_raises_the_tool_and_ends_the_motion(client: Client, toy: Toy) -> None:
    motion = begun(client)
    client.poll(motion)
    client.stop()
    assert toy.stops == 1
    assert client.poll(motion).status is Status.DONE
    assert client.state.trip == ""


def test_a_poll_of_another_motion_is_an_error(client: Client) -> None:
    with pytest.raises(RobotError, match="the motion that began last is not 1"):
        client.poll(1)
    motion = begun(client)
    assert client.poll(motion).status is Status.RUNNING, "the connection has outlived the error"


def test_one_client_has_control(server: Server, client: Client) -> None:
    with pytest.raises(RobotError, match="another client has control"):
        Client(server.address)
    with Client(server.address, control=False) as other:
        assert other.description == TOY
        other.refresh()
        assert other.state.clock > client.state.clock
        with pytest.raises(RobotError, match="takes control"):
            other.observe()
    client.close()
    deadline = time.monotonic() + 2
    while True:  # the server learns of it a moment later
        try:
            Client(server.address).close()
            return
        except RobotError:
            assert time.monotonic() < deadline


def test_a_client_that_goes_in_mid_motion_trips_the_robot(server: Server, client: Client, toy: Toy) -> None:
    begun(client)
    client.close()
    gone = time.monotonic()
    while not toy.stops:
        assert time.monotonic() - gone < TOY.lease
    with Client(server.address) as other:
        assert "connection ended" in other.state.trip
        refused = other.start(ACROSS)
        assert isinstance(refused, Refusal)
        assert refused.reason.startswith("it has tripped")
        other.observe()
        with Client(server.address, control=False) as person:
            person.rearm()
        assert isinstance(other.start(ACROSS), int)


def test_a_client_that_hangs_trips_the_robot(client: Client, toy: Toy) -> None:
    motion = begun(client)
    client.poll(motion)
    time.sleep(TOY.lease + 0.1)
    assert toy.stops == 1
    answer = client.poll(motion)
    assert answer.status is Status.FAILED
    assert answer.failure == client.state.trip != ""


def test_a_client_that_hangs_keeps_no_control(server: Server, client: Client) -> None:
    begun(client)
    time.sleep(TOY.lease + 0.1)
    with Client(server.address) as other:
        other.rearm()
        begun(other)
        other.stop()
        with pytest.raises(RobotError, match=r"has ended the connection|can no longer be reached"):
            client.stop()


@pytest.mark.parametrize("host", ["0.0.0.0", "10.1.2.3", "::", "robot.lab"])
def test_a_driver_listens_on_its_own_machine_alone(toy: Toy, host: str) -> None:
    with pytest.raises(ValueError, match=r"listens at 127\.0\.0\.1 or ::1, and not at"):
        Server(toy, TOY, Address(host, 0))


def test_a_terminal_that_has_gone_ends_no_connection(toy: Toy) -> None:
    def told(text: str) -> None:
        raise BrokenPipeError

    with closing(Server(toy, TOY, ANYWHERE, told)) as server:
        Thread(target=server.serve, daemon=True).start()
        for _ in range(2):
            with Client(server.address) as client:
                assert not client.state.trip
                begun(client)
                client.stop()


def test_a_driver_that_can_take_no_more_clients_goes_on(
    server: Server, client: Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    def start(thread: Thread) -> None:
        raise RuntimeError("can't start new thread")

    with monkeypatch.context() as lacking:
        lacking.setattr("cleancli.remote.server.threading.Thread.start", start)
        with pytest.raises(RobotError, match="has ended the connection"):
            Client(server.address, control=False)
    with Client(server.address, control=False) as other:
        other.refresh()
    begun(client)


def test_a_cut_connection_is_told_in_time(server: Server, client: Client) -> None:
    begun(client)
    server.close()
    with pytest.raises(RobotError, match=r"has ended the connection|can no longer be reached"):
        client.stop()


@pytest.mark.parametrize(
    "nonsense",
    [
        b"GET / HTTP/1.1\r\nHost: robot\r\n\r\n",
        bytes(range(64)),
        b"nidr" + struct.pack(">I", 1 << 30),
        b"".join(map(bytes, encoded(Message({"request": "start"}, {"waypoints": np.zeros((10_001, 5))})))),
    ],
)
def test_nonsense_ends_its_connection_alone(server: Server, client: Client, nonsense: bytes) -> None:
    host, port = server.address.host, server.address.port
    with socket.create_connection((host, port)) as other:
        other.sendall(nonsense)
        other.settimeout(2)
        answer = other.recv(1 << 16)
        assert b'"error"' in answer
        with suppress(ConnectionResetError):  # of what was sent and not read
            assert not other.recv(1)
    client.observe()


@pytest.mark.parametrize(
    ("head", "reason"),
    [
        ({"request": "dance"}, "there is no request `dance`"),
        ({"request": 1}, "`request` is no line"),
        ({}, "`request` is missing"),
        ({"request": "stop", "now": True}, "there is no key `now`"),
        ({"request": "hello", "version": 9, "control": False}, "version 1"),
    ],
)
def test_what_is_no_request_is_told_and_outlived(
    client: Client, head: dict[str, object], reason: str
) -> None:
    client._transport.send(Message(head), 1.0)
    answer = client._transport.receive(1.0, 1.0)
    assert reason in answer.head["error"]
    client.observe()


def test_more_clients_than_there_are_places_for_are_turned_away(server: Server) -> None:
    address = server.address.host, server.address.port
    there = [Client(server.address, control=False) for _ in range(MOST_CLIENTS)]
    with socket.create_connection(address) as one_more:
        one_more.settimeout(2)
        assert one_more.recv(1) == b""
    for each in there:
        each.close()


def test_a_driver_that_fails_to_look_trips(toy: Toy, monkeypatch: pytest.MonkeyPatch) -> None:
    def dark() -> FramePair:
        raise RuntimeError("the lens cap is on")

    monkeypatch.setattr(toy, "observe", dark)
    with served(toy) as server, Client(server.address) as client:
        with pytest.raises(RobotError, match="the lens cap is on"):
            client.observe()
        refused = client.start(ACROSS)
        assert isinstance(refused, Refusal)


def test_pictures_that_no_message_holds_are_an_error(toy: Toy, monkeypatch: pytest.MonkeyPatch) -> None:
    pair = replace(toy.observe(), depth=np.zeros((6, 8), np.int64))
    monkeypatch.setattr(toy, "observe", lambda: pair)
    with served(toy) as server, Client(server.address) as client:
        with pytest.raises(RobotError, match="`depth` holds int64"):
            client.observe()
        client.stop()


def test_a_driver_that_does_not_answer_is_given_up(toy: Toy, monkeypatch: pytest.MonkeyPatch) -> None:
    with served(toy) as server, Client(server.address, answering=0.2) as client:
        monkeypatch.setattr(toy, "can_follow", lambda path, errors: time.sleep(0.5))
        with pytest.raises(RobotError, match=r"does not answer within 0\.2 s"):
            client.can_follow(ACROSS, 0.0)
        with pytest.raises(RobotError, match=r"does not answer within 0\.2 s"):
            client.stop()


def test_a_reply_that_does_not_end_is_told_as_such(monkeypatch: pytest.MonkeyPatch) -> None:
    """And so it is to whoever asks next: the connection has ended."""
    monkeypatch.setattr("cleancli.remote.client.PATIENCE", 0.2)
    hello = reply(State(0.0, (0.0, 0.0, 0.2), ""), **described(TOY))
    with socket.create_server(("127.0.0.1", 0)) as listener:

        def answer() -> None:
            connection, _ = listener.accept()
            with connection:
                for piece in encoded(hello):
                    connection.sendall(piece)
                connection.sendall(b"nidr\0\0\0\x09{")
                while connection.recv(1 << 16):
                    pass

        thread = Thread(target=answer)
        thread.start()
        with Client(Address("127.0.0.1", listener.getsockname()[1])) as client:
            for ask in (client.refresh, client.stop):
                with pytest.raises(RobotError, match=r"has begun a message and not ended it within 0\.2 s"):
                    ask()
        thread.join()


def test_a_clock_that_runs_back_is_no_clock(server: Server, client: Client, toy: Toy) -> None:
    toy._began += 100
    with pytest.raises(Broken, match="its clock runs back"):
        client.stop()


def test_where_nobody_listens_is_told() -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
    with pytest.raises(RobotError, match=f"no driver answers at 127.0.0.1:{port}: .*refused"):
        Client(Address("127.0.0.1", port))


@pytest.mark.parametrize(
    ("text", "address"),
    [
        ("127.0.0.1:7420", Address("127.0.0.1", 7420)),
        ("localhost:1", Address("127.0.0.1", 1)),
        ("127.8.0.1:65535", Address("127.8.0.1", 65535)),
        ("[::1]:7420", Address("::1", 7420)),
    ],
)
def test_addresses_of_this_machine(text: str, address: Address) -> None:
    assert address_of(text) == address
    assert address_of(str(address)) == address


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("192.168.1.7:7420", "ssh -N -L 7420:127.0.0.1:7420 192.168.1.7"),
        ("0.0.0.0:7420", "another machine"),
        ("robot.lab:7420", "robot.lab` is another machine"),
        ("127.0.0.1", "a host and a port"),
        ("127.0.0.1:0", "a host and a port"),
        ("127.0.0.1:65536", "a host and a port"),
        ("127.0.0.1:999999999999", "a host and a port"),
        ("127.0.0.1:٣", "a host and a port"),
        (":7420", "a host and a port"),
        ("", "a host and a port"),
    ],
)
def test_other_addresses_are_refused(text: str, reason: str) -> None:
    with pytest.raises(ValueError, match=reason):
        address_of(text)
