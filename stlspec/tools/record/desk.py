"""One thread that does all the work, asked by many.

In: functions, from the threads that serve requests. Out: what they return. Environments, and the libraries that
render them, often work in one thread only, so the sitting is touched by the thread that runs the desk: the main one,
where Ctrl-C arrives too.
"""

from collections.abc import Callable
from concurrent.futures import Future
from queue import Empty, SimpleQueue
from typing import Any, TypeVar

Answer = TypeVar("Answer")
_LONGEST_WAIT = 60.0
_GLANCE = 0.5


class ClosedError(Exception):
    """The desk answers no more."""


class Desk:
    """Takes orders from any thread; `run` carries them out in its own."""

    def __init__(self) -> None:
        # SimpleQueue, because its `put` may be called from a signal handler that has interrupted `get`.
        self._orders: SimpleQueue[tuple[Callable[[], Any], Future[Any]] | None] = SimpleQueue()
        self._open = True

    def ask(self, order: Callable[[], Answer]) -> Answer:
        """Have something done, and wait for what it returns or raises.

        Raises: ClosedError: the desk is closed. TimeoutError: it took too long.
        """
        future: Future[Any] = Future()
        self._orders.put((order, future))
        if not self._open:
            self._turn_away()
        answer: Answer = future.result(_LONGEST_WAIT)
        return answer

    def close(self) -> None:
        """Let `run` return after what it is doing; may be called from a signal handler."""
        self._orders.put(None)

    def run(self, deserted: Callable[[], bool]) -> None:
        """Carry out orders until `close` is called or `deserted` says that nobody is there any more.

        Raises: whatever interrupts it, such as KeyboardInterrupt.
        """
        try:
            while not deserted():
                try:
                    order = self._orders.get(timeout=_GLANCE)
                except Empty:
                    continue
                if order is None:
                    return
                self._carry_out(*order)
        finally:
            self._open = False
            self._turn_away()

    def _carry_out(self, order: Callable[[], Any], future: "Future[Any]") -> None:
        try:
            future.set_result(order())
        except Exception as error:  # It is raised where it was asked for.
            future.set_exception(error)

    def _turn_away(self) -> None:
        while True:
            try:
                order = self._orders.get_nowait()
            except Empty:
                return
            if order is not None:
                order[1].set_exception(ClosedError())
