"""What an editor sends is read with a limit, whatever length it announces."""

from __future__ import annotations

import io
import subprocess
import sys

import pytest

from cleancli.editor.messages import LARGEST, LONGEST, Limited


def test_messages_of_usual_size_pass_as_they_are() -> None:
    sent = b"Content-Length: 4\r\nContent-Type: x\r\n\r\nbody" + b"content-length:2\r\n\r\n{}"
    stream = Limited(io.BytesIO(sent))
    read = [stream.readline(), stream.readline(), stream.readline(), stream.read(4)]
    assert b"".join([*read, stream.readline(), stream.readline(), stream.read(2)]) == sent
    assert (stream.readline(), stream.refused) == (b"", "")
    assert Limited(io.BytesIO(f"Content-Length: {LARGEST}\r\n".encode())).readline()


@pytest.mark.parametrize(
    "sent",
    [
        f"Content-Length: {LARGEST + 1}\r\n".encode(),
        b"Content-Length: " + b"9" * 3000 + b"\r\n",
        b"CONTENT-LENGTH:   99999999999 \r\n",
        b"x" * (LONGEST + 1),
    ],
)
def test_what_is_too_large_ends_the_conversation(sent: bytes) -> None:
    stream = Limited(io.BytesIO(sent + b"\r\n{}"))
    assert stream.readline() == b""
    assert "longer than" in stream.refused or "was announced" in stream.refused
    assert stream.read(10**12) == b""


def test_a_server_that_is_told_of_terabytes_leaves_with_a_sentence() -> None:
    ended = subprocess.run(
        [sys.executable, "-m", "cleancli.cli.main", "lsp"],
        input=b"Content-Length: 1000000000000\r\n\r\n{}",
        capture_output=True,
        timeout=60,
    )
    assert ended.returncode == 5
    assert ended.stderr == b"error: a message of 1000000000000 bytes was announced: the editor was cut off\n"
    assert ended.stdout == b""


def test_a_message_nested_too_deeply_is_answered_and_the_next_one_too() -> None:
    deep = b"[" * 200_000
    asked = b'{"jsonrpc": "2.0", "id": 1, "method": "shutdown"}'
    sent = b"".join(b"Content-Length: %d\r\n\r\n%s" % (len(each), each) for each in (deep, asked))
    ended = subprocess.run(
        [sys.executable, "-m", "cleancli.cli.main", "lsp"], input=sent, capture_output=True, timeout=60
    )
    assert ended.returncode == 0
    assert b'"id":1' in ended.stdout.replace(b" ", b"")
