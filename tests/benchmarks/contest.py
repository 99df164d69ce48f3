"""Contestants that are timed in turn, each in a process of its own.

In: jobs by label. Out: a `Figure` for each label. The rounds are interleaved: in every round each contestant is
timed once, so that what else the machine does falls on all alike; the figure is the median of the rounds.
"""

import json
import os
import selectors
import statistics
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from tests.peers.environments import NotInstalledError, environment

PEERS = Path(__file__).parent / "peers"


class OutOfTimeError(Exception):
    """A contestant took longer than it may."""


class OwnFailureError(Exception):
    """stlspec itself could not do a job: nothing to compare with."""


@dataclass(frozen=True)
class Figure:
    """Seconds a unit: median, least and greatest of the rounds; or why there are none."""

    median: float | None = None
    least: float | None = None
    most: float | None = None
    values: tuple = ()
    error: str = ""

    @classmethod
    def of(cls, rounds, values=()):
        return cls(statistics.median(rounds), min(rounds), max(rounds), tuple(values))


class Worker:
    """The process of one contestant."""

    def __init__(self, tool, python):
        self.tool, self._python, self._process = tool, python, None
        self._buffer = b""
        self.version = ""

    def ask(self, request, seconds):
        """Send a request and return the answer; start the process if there is none.

        Raises: OutOfTimeError: no answer within `seconds`. RuntimeError: an error there, or the process ended.
        """
        if self._process is None:
            self._start(seconds)
        self._process.stdin.write(json.dumps(request).encode() + b"\n")
        self._process.stdin.flush()
        return self._answer(seconds)

    def stop(self):
        """End the process."""
        if self._process is not None:
            self._process.kill()
            self._process.communicate()
            self._process, self._buffer = None, b""

    def _start(self, seconds):
        script = PEERS / f"with_{self.tool}.py"
        environ = {**os.environ, "PYTHONHASHSEED": "0", "OMP_NUM_THREADS": "1"}
        command = [str(self._python), str(script)]
        self._process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, env=environ
        )
        self.version = self._answer(seconds)["version"]

    def _answer(self, seconds):
        out = self._process.stdout
        with selectors.DefaultSelector() as ready:
            ready.register(out, selectors.EVENT_READ)
            while b"\n" not in self._buffer:
                if not ready.select(seconds):
                    self.stop()
                    raise OutOfTimeError(f"no answer within {seconds:.0f} s")
                chunk = os.read(out.fileno(), 65536)
                if not chunk:
                    self.stop()
                    raise RuntimeError("the process ended")
                self._buffer += chunk
        line, _, self._buffer = self._buffer.partition(b"\n")
        answer = json.loads(line)
        if "error" in answer:
            raise RuntimeError(answer["error"])
        return answer


@dataclass
class Arena:
    """All contestants, and how long they are timed. quick: fewer rounds, shorter rounds."""

    work: Path
    quick: bool = False
    patience: float = 120.0

    def __post_init__(self):
        self.missing = {}
        self.versions = {}
        self.rounds, self.at_least = (3, 0.005) if self.quick else (7, 0.05)

    def worker(self, tool):
        """The process of a tool; each label of a contest has one of its own."""
        if tool == "stlspec":
            return Worker(tool, sys.executable)
        return Worker(tool, environment(tool, self.work).python)

    def install(self, tools):
        """Make the environments of the tools; remember which cannot be had, and why."""
        for tool in tools:
            try:
                environment(tool, self.work)
            except NotInstalledError as error:
                self.missing[tool] = str(error)

    def contest(self, jobs):
        """Time jobs {label: (tool, job)} in turn and return {label: Figure}."""
        figures, ready, rounds = {}, {}, {}
        try:
            for label, (tool, job) in jobs.items():
                self._prepare(label, tool, job, ready, figures)
            rounds = {label: [] for label in ready}
            for _ in range(self.rounds):
                for label in list(ready):
                    self._time(label, ready, rounds, figures)
            for label, worker in ready.items():
                values = worker.ask({"values": True}, self.patience)["values"]
                figures[label] = Figure.of(rounds[label], values)
                self.versions[worker.tool] = worker.version
        finally:
            for worker in ready.values():
                worker.stop()
        for label, (tool, _) in jobs.items():
            if tool == "stlspec" and figures[label].error:
                raise OwnFailureError(f"{label}: {figures[label].error}")
        return {label: figures[label] for label in jobs}

    def quantiles(self, tool, job, count, wanted):
        """Return quantiles of single calls in seconds, by the wall clock."""
        worker = self.worker(tool)
        try:
            worker.ask({"prepare": job}, self.patience)
            return worker.ask({"count": count, "quantiles": wanted}, self.patience)["seconds"]
        finally:
            worker.stop()

    def values(self, tool, job):
        """Return what a job yields, untimed."""
        worker = self.worker(tool)
        try:
            worker.ask({"prepare": job}, self.patience)
            return worker.ask({"values": True}, self.patience)["values"]
        finally:
            worker.stop()

    def _prepare(self, label, tool, job, ready, figures):
        if tool in self.missing:
            figures[label] = Figure(error=f"not installed: {self.missing[tool]}")
            return
        worker = self.worker(tool)
        try:
            worker.ask({"prepare": job}, self.patience)
            # One round that does not count: first calls fill caches and compile.
            worker.ask({"measure": 0.0}, self.patience)
            ready[label] = worker
        except (OutOfTimeError, RuntimeError) as error:
            worker.stop()
            figures[label] = Figure(error=str(error))

    def _time(self, label, ready, rounds, figures):
        try:
            rounds[label].append(ready[label].ask({"measure": self.at_least}, self.patience)["seconds"])
        except (OutOfTimeError, RuntimeError) as error:
            ready.pop(label).stop()
            figures[label] = Figure(error=str(error))
