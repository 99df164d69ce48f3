"""Every message arrives, whatever stands between messages and however the bytes are parted."""

import io
import json
import queue
import random
import threading

import pytest

from stlspec.tools.lsp import transport
from stlspec.tools.lsp.transport import END, Inbox, TooLongError, bodies, framed

MESSAGES = [{"jsonrpc": "2.0", "id": i, "text": "é" * i} for i in range(5)]


def read(data):
    return list(bodies(io.BytesIO(data).read))


def test_messages_arrive_in_whatever_pieces():
    data = b"".join(map(framed, MESSAGES))
    rng = random.Random(0)
    stream = io.BytesIO(data)
    found = bodies(lambda most: stream.read(min(most, rng.randint(1, 7))))
    assert [json.loads(body) for body in found] == MESSAGES


@pytest.mark.parametrize(
    "between",
    [
        b"\r\n\r\n",
        b"garbage",
        b"Content-Length: many\r\n\r\n{}",
        b"Content-Length: -3\r\n\r\n",
        b"Content-Length: 99999999999999999999\r\n\r\n",
        b"Content-Length: 123456789012\r\nContent-Type: x\r\n\r\n{}",
        b"x" * 200_000,
        bytes(range(256)),
    ],
)
def test_what_is_no_message_costs_no_other(between):
    data = framed(MESSAGES[0]) + between + framed(MESSAGES[1])
    found = [json.loads(body) for body in read(data) if not isinstance(body, TooLongError)]
    assert [message for message in found if message] == MESSAGES[:2]


def test_headers_may_be_several_in_any_order_and_case():
    body = framed(MESSAGES[2]).split(b"\r\n\r\n")[1]
    data = b"Content-Type: application/json\r\ncontent-length: %d\r\nX: y\r\n\r\n%b" % (len(body), body)
    assert [json.loads(b) for b in read(data + data)] == [MESSAGES[2]] * 2


def test_an_absurd_length_is_said():
    (found,) = read(b"Content-Length: 99999999999999999999\r\n\r\n")
    assert "99999999999999999999 bytes" in str(found)


def test_a_stream_that_is_cut_ends():
    data = framed(MESSAGES[0]) + framed(MESSAGES[4])
    for end in range(len(data)):
        assert len(read(data[:end])) == (end >= len(framed(MESSAGES[0])))


def test_headers_without_end_are_not_kept():
    assert read(b"Content-Length: 5\r\n" + b"a: b\r\n" * 5000) == []


def test_the_inbox_says_what_is_no_message_and_goes_on():
    deep = b"[" * 100_000
    bad = [b"{", b"[]", b"null", b"\xff", deep, b"1" * 5000]
    data = b"".join(b"Content-Length: %d\r\n\r\n%b" % (len(b), b) for b in bad) + framed(MESSAGES[0])
    inbox = Inbox(io.BytesIO(data).read)
    found = [inbox.get(5) for _ in range(len(bad) + 2)]
    assert [type(message) for message in found[:-2]] == [ValueError] * len(bad)
    assert found[-2:] == [MESSAGES[0], END]


def test_the_inbox_waits_for_a_while_only():
    open_pipe = threading.Event()
    inbox = Inbox(lambda most: open_pipe.wait(5) and b"")
    with pytest.raises(queue.Empty):
        inbox.get(0.01)
    open_pipe.set()
    assert inbox.get(5) is END


def test_a_request_taken_back_before_its_turn_is_known():
    cancel = {"method": "$/cancelRequest", "params": {"id": 7}}
    inbox = Inbox(io.BytesIO(framed({"id": 7, "method": "x"}) + framed(cancel) + framed({"method": "exit"})).read)
    messages = [inbox.get(5) for _ in range(4)]
    assert messages[-1] is END
    assert inbox.cancelled(7)
    assert not inbox.cancelled(7)
    assert not inbox.cancelled([])


def test_nothing_is_read_after_exit():
    stream = io.BytesIO(framed({"method": "exit"}) + framed(MESSAGES[0]))
    inbox = Inbox(lambda most: stream.read(10))
    assert [inbox.get(5), inbox.get(5)] == [{"method": "exit"}, END]


def test_a_stream_that_breaks_is_at_its_end():
    def broken(most):
        raise OSError

    assert Inbox(broken).get(5) is END


def test_a_body_of_the_largest_size_is_read_and_a_larger_one_is_not(monkeypatch):
    monkeypatch.setattr(transport, "LARGEST_MESSAGE", 10)
    assert read(b"Content-Length: 10\r\n\r\n0123456789") == [b"0123456789"]
    (found,) = read(b"Content-Length: 11\r\n\r\n01234567890")
    assert isinstance(found, TooLongError)


def test_a_header_that_does_not_end_is_given_up_and_what_comes_after_it_is_read():
    parts = iter([b"Content-Length: 2\r\nX: ", b"a" * 5000, framed({"id": 1}), b""])
    assert list(bodies(lambda _: next(parts))) == [b'{"id": 1}']
