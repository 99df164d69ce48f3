"""The desk works in one thread, whoever asks; and nobody waits for an answer that will not come."""

import threading
import time

import pytest

from stlspec.tools.record.desk import ClosedError, Desk


def running(desk: Desk, deserted=lambda: False) -> threading.Thread:
    thread = threading.Thread(target=desk.run, args=(deserted,))
    thread.start()
    return thread


def test_all_orders_are_carried_out_by_one_thread_in_turn() -> None:
    desk = Desk()
    thread = running(desk)
    seen: list[int] = []

    def work() -> int:
        seen.append(threading.get_ident())
        return len(seen)

    askers = [threading.Thread(target=lambda: [desk.ask(work) for _ in range(50)]) for _ in range(4)]
    for asker in askers:
        asker.start()
    for asker in askers:
        asker.join()
    assert len(seen) == 200
    assert set(seen) == {thread.ident}
    desk.close()
    thread.join(5)
    assert not thread.is_alive()


def test_an_error_is_raised_where_it_was_asked_for_and_the_desk_goes_on() -> None:
    desk = Desk()
    thread = running(desk)
    with pytest.raises(ZeroDivisionError):
        desk.ask(lambda: 1 / 0)
    assert desk.ask(lambda: 3) == 3
    desk.close()
    thread.join(5)
    with pytest.raises(ClosedError):
        desk.ask(lambda: 4)


def test_a_deserted_desk_closes() -> None:
    start = time.monotonic()
    Desk().run(lambda: time.monotonic() - start > 0.2)
    assert time.monotonic() - start < 5
