"""Messages on a stream of bytes, whatever else is on it.

In: bytes, as they come. Out: the body of each message of at most `LARGEST_MESSAGE` bytes. A header is sought wherever
it stands, so that what is no message, or claims an absurd length, costs nothing but itself: JSON holds no bare line
end, so no body looks like a header.
"""

import json
import queue
import re
import threading
from collections.abc import Callable, Iterator
from typing import Any

from stlspec.compiler.files import LARGEST_SPEC

LARGEST_MESSAGE = 8 * LARGEST_SPEC
"""Bytes: a spec of the largest size fits, however its characters are written in JSON."""
_CHUNK = 2**16
_HEADER = re.compile(rb"content-length:[ \t]*(\d{1,20})[ \t]*\r?\n", re.IGNORECASE)
_LONGEST_HEADER = 4096
_WAITING = 1000
"""How many messages are read ahead at most."""

Read = Callable[[int], bytes]
"""Returns some bytes, at most as many as asked for; none at the end of the stream."""


class TooLongError(Exception):
    """A message announces a body that is too long; it is not read."""


class _End:
    """What stands for the end of the stream."""


END = _End()
Message = dict[str, Any] | Exception | _End


def bodies(read: Read) -> Iterator[bytes | TooLongError]:
    """Yield the body of each message until the stream ends."""
    buffer = bytearray()
    while True:
        match = _HEADER.search(buffer)
        end = _end_of_headers(buffer, match.end()) if match is not None else None
        if match is None or end is None:
            if match is None or len(buffer) - match.end() > _LONGEST_HEADER:
                del buffer[: match.end() if match is not None else max(0, len(buffer) - 64)]
            data = read(_CHUNK)
            if not data:
                return
            buffer += data
            continue
        length = int(match[1])
        if length > LARGEST_MESSAGE:
            del buffer[: match.end()]
            yield TooLongError(f"a message of {length} bytes; at most {LARGEST_MESSAGE} are read")
            continue
        del buffer[:end]
        while len(buffer) < length:
            data = read(min(_CHUNK, length - len(buffer)))
            if not data:
                return
            buffer += data
        yield bytes(buffer[:length])
        del buffer[:length]


def _end_of_headers(buffer: bytearray, start: int) -> int | None:
    """Return where the blank line after a header ends; None if it has not come."""
    match = re.compile(rb"(?:[^\r\n]+\r?\n)*?\r?\n").match(buffer, start)
    return match.end() if match is not None else None


def framed(message: Any) -> bytes:
    """Return a message with its header."""
    body = json.dumps(message).encode()
    return b"Content-Length: %d\r\n\r\n%b" % (len(body), body)


class Inbox:
    """Messages read ahead by a thread of its own, so that one can wait for them for a while.

    A request that is taken back before its turn comes is known to be: `cancelled`.
    """

    def __init__(self, read: Read) -> None:
        self._queue: queue.Queue[Message] = queue.Queue(_WAITING)
        self._cancelled: set[Any] = set()
        self._thread = threading.Thread(target=self._fill, args=(read,), daemon=True)
        self._thread.start()

    def _fill(self, read: Read) -> None:
        try:
            for body in bodies(read):
                message = _parsed(body)
                self._note(message)
                self._queue.put(message)
                if isinstance(message, dict) and message.get("method") == "exit":
                    break
        except OSError:
            pass  # the stream is gone, which is its end
        self._queue.put(END)

    def _note(self, message: Message) -> None:
        if isinstance(message, dict) and message.get("method") == "$/cancelRequest":
            params = message.get("params")
            name = params.get("id") if isinstance(params, dict) else None
            if isinstance(name, int | str):
                if len(self._cancelled) >= _WAITING:
                    self._cancelled.clear()  # of requests that were answered before they were taken back
                self._cancelled.add(name)

    def cancelled(self, name: Any) -> bool:
        """Tell, once, whether a request was taken back."""
        if isinstance(name, int | str) and name in self._cancelled:
            self._cancelled.discard(name)
            return True
        return False

    def get(self, seconds: float | None) -> Message:
        """Return the next message, an exception for what is none, or `END`.

        Raises: queue.Empty: none has come in that time.
        """
        return self._queue.get(timeout=seconds)


def _parsed(body: bytes | TooLongError) -> Message:
    if isinstance(body, TooLongError):
        return body
    try:
        message = json.loads(body)
    except (ValueError, RecursionError) as error:
        return ValueError(f"a message that is no JSON: {error}")
    return message if isinstance(message, dict) else ValueError("a message that is no JSON object")
