"""A recording from beginning to end: the sitting, its page, and what remains when it is over.

In: a spec, an environment, a file. Out: demonstrations in the file, and an account of them. It ends when the page
says so, some time after the page was closed, or on Ctrl-C; in each case what was done is saved first, and no thread
and no socket remains.
"""

import secrets
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from stlspec.compiler.bundle import BundleData
from stlspec.envs.model import Environment
from stlspec.errors import UsageError, diagnostic
from stlspec.scores import Ranking
from stlspec.tools.record.desk import Desk
from stlspec.tools.record.server import PATIENCE, PageServer
from stlspec.tools.record.session import Session
from stlspec.tools.record.storage import DemoFile
from stlspec.tools.record.world import World

_SIGNALS = ("SIGINT", "SIGTERM", "SIGHUP")


@dataclass(frozen=True, slots=True)
class Recorded:
    """What a sitting left: the file, (name, samples) of each demonstration, their ranking, and all of it in words.

    interrupted: whether a signal ended it.
    """

    file: str
    demonstrations: tuple[tuple[str, int], ...]
    ranking: Ranking | None
    account: str
    interrupted: bool

    def to_json(self) -> dict[str, Any]:
        """Return the `stlspec.record/1` document."""
        rows = {} if self.ranking is None else {d.name: d for d in self.ranking.demonstrations}
        return {
            "schema": "stlspec.record/1",
            "file": self.file,
            "demonstrations": [
                {
                    "name": name,
                    "samples": samples,
                    **{key: getattr(rows.get(name), key, None) for key in ("label", "reward", "rank")},
                }
                for name, samples in self.demonstrations
            ],
        }


def record(
    bundle: BundleData | None,
    environment: Environment,
    out: Path,
    *,
    port: int = 0,
    seed: int = 0,
    patience: float = PATIENCE,
    ready: Callable[[str], None] = print,
) -> Recorded:
    """Serve the page of a recording until it is over.

    Paper: its demonstrations came from a point-and-click game.

    Args:    bundle: the spec that is watched; None = only record. environment: where. out: .jsonl or .json, added
             to if it exists. port: 0 = any. seed: of the first episode; each one has its own. patience: seconds
             that it goes on after its page was closed. ready: is told the URL.
    Returns: what was saved.
    Raises:  InputError: D885 to D887, or the spec does not fit the environment; or what was recorded cannot be
             saved, and the message says where it is kept.
    """
    file = DemoFile(out)
    world = World(environment, seed)
    try:
        session = Session(bundle, world, file)
        desk = Desk()
        server = _server(port, desk, session)
        server.patience = patience
    except BaseException:
        world.close()
        raise
    caught: list[int] = []
    try:
        with _serving(server), _signals(desk, caught):
            ready(server.url)
            desk.run(server.deserted)
    finally:
        # A second Ctrl-C gets here at once; what was recorded is saved all the same.
        account = session.close()
    saved = tuple((d.name, d.n_samples) for d in session.saved)
    return Recorded(str(out), saved, session.ranking, account, bool(caught))


def _server(port: int, desk: Desk, session: Session) -> PageServer:
    try:
        return PageServer(port, secrets.token_urlsafe(24), desk, session)
    except (OSError, OverflowError) as error:
        problem = (getattr(error, "strerror", None) or str(error)).lower()
        raise UsageError([diagnostic("D887", port=port, problem=problem)]) from None


@contextmanager
def _serving(server: PageServer) -> Iterator[None]:
    """Answer requests in the background."""
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.1}, daemon=True)
    thread.start()
    try:
        yield
    finally:
        server.farewell()
        server.shutdown()
        thread.join()
        server.server_close()


@contextmanager
def _signals(desk: Desk, caught: list[int]) -> Iterator[None]:
    """Let the first signal that would end the program close the desk, so that nothing is cut in the middle."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def close(number: int, _frame: Any) -> None:
        if caught:
            raise KeyboardInterrupt
        caught.append(number)
        desk.close()

    numbers = [getattr(signal, name) for name in _SIGNALS if hasattr(signal, name)]
    before = {number: signal.signal(number, close) for number in numbers}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
