"""A sitting: several demonstrations made one after another, each saved when it is done.

In: what the page asks for, as small documents. Out: what the page shows, as one document; the file. A request says
which revision it was made for, so that of two tabs, or of a double click, the second one does not step blindly.
"""

from collections.abc import Mapping
from typing import Any

from stlspec.compiler.bundle import BundleData
from stlspec.compiler.bundle_file import number
from stlspec.compiler.printing import counted
from stlspec.demos import Demonstration, document_of
from stlspec.errors import InputError
from stlspec.scores import Ranking, score, value_text
from stlspec.tools.record.moves import RefusedError, action_to
from stlspec.tools.record.storage import DemoFile
from stlspec.tools.record.take import Follower, Standings, Take
from stlspec.tools.record.world import Moment, World

MOST_SAMPLES = 10_000
LONGEST_NAME = 80
_MOST_SCORED = 500


class Session:
    """A sitting. Use it from one thread."""

    def __init__(self, bundle: BundleData | None, world: World, file: DemoFile) -> None:
        """Begin. Raises: InputError: the spec does not fit the environment, or the environment fails."""
        self._bundle, self._world, self._file = bundle, world, file
        self._environment = world.environment
        self._follower = None if bundle is None else Follower(bundle, world.environment)
        self.saved: list[Demonstration] = []
        self.ranking: Ranking | None = None
        self._trouble = ""
        self.revision = 0
        self._episode = 0
        self._take = Take(0, (world.reset(0),))
        if self._follower is not None:
            self._follower.check(self._take)
        world.frame()
        self._standings = self._known()

    @property
    def unsaved(self) -> bool:
        """Whether steps were taken that are in no file yet."""
        return bool(self._take.actions)

    def act(self, request: Mapping[str, Any]) -> dict[str, Any]:
        """Do what the page asks for; return what it shows then, with "refused" if it was not done, and why."""
        refused, said = "", ""
        try:
            if request.get("revision") != self.revision:
                raise RefusedError("Another tab, or a second click, was faster. This is how it stands now.")
            said = self._do(request)
            self.revision += 1
        except RefusedError as error:
            refused = str(error)
        except InputError as error:
            found = error.diagnostics[0]
            refused = f"{found.message[:1].upper()}{found.message[1:]}. {found.help[:1].upper()}{found.help[1:]}."
        return {**self.view(), "refused": refused, "said": said}

    def _do(self, request: Mapping[str, Any]) -> str:
        match request:
            case {"do": "act", "action": int(action)} if not isinstance(action, bool):
                return self._step(action)
            case {"do": "go", "row": int(row), "column": int(column)} if self._world.kind == "map":
                return self._go(row, column)
            case {"do": "undo"}:
                return self._undo()
            case {"do": "restart"}:
                self._episode += 1
                self._begin()
                return "Back at the start."
            case {"do": "save", "name": str(name)}:
                return self._save(name)
            case {"do": "remove", "name": str(name)}:
                return self._remove(name)
        raise RefusedError("That is nothing this page can do.")

    def _go(self, row: int, column: int) -> str:
        self._check_open()
        here = self._environment.encode(self._take.moments[-1].state)
        return self._step(action_to(self._environment, here, row, column) + self._world.first_action)

    def _check_open(self) -> None:
        if self._take.ended:
            why = self._take.ended
            raise RefusedError(f"{why[:1].upper()}{why[1:]}: undo the last step, start over, or save.")
        if len(self._take.moments) >= MOST_SAMPLES:
            raise RefusedError(f"A demonstration has at most {MOST_SAMPLES:,} samples. Save it, or undo.")

    def _step(self, action: int) -> str:
        first = self._world.first_action
        if not first <= action < first + self._world.n_actions:
            raise RefusedError(f"There is no action {action}.")
        self._check_open()
        before = self._take.moments[-1]
        moment = self._world.step(action)
        self._take = self._take.then(action, moment)
        self._standings = self._known()
        return self._told(before, moment)

    def _told(self, before: Moment, moment: Moment) -> str:
        """Say what a step did, where that is not plain to see."""
        if moment.ended:
            return f"{moment.ended[:1].upper()}{moment.ended[1:]}."
        if self._world.kind == "map" and before.state == moment.state:
            return "You stayed where you are; the step counts all the same."
        return ""

    def _undo(self) -> str:
        if not self._take.actions:
            raise RefusedError("There is nothing to undo.")
        wanted = self._take.before()
        there = self._world.rewind(wanted.episode, wanted.actions)
        if there.state != wanted.moments[-1].state:
            lost = Moment(self._take.moments[-1].state, self._take.moments[-1].info, "the environment lost its way")
            self._take = Take(self._take.episode, (*self._take.moments[:-1], lost), self._take.actions)
            raise RefusedError("This environment does not repeat itself, so no step can be undone. Save or start over.")
        self._take = wanted
        self._standings = self._known()
        return "Undone."

    def _begin(self) -> None:
        self._take = Take(self._episode, (self._world.reset(self._episode),))
        self._standings = self._known()

    def proposed_name(self) -> str:
        """Return a name that is free."""
        taken = self._names()
        k = len(self.saved) + 1
        while f"demo {k}" in taken:
            k += 1
        return f"demo {k}"

    def _names(self) -> set[str]:
        return {d.name for d in (*self._file.existing, *self.saved)}

    def _save(self, name: str) -> str:
        name = name.strip()
        if not self._take.actions:
            raise RefusedError("Nothing has happened yet: take at least one step.")
        if not name or len(name) > LONGEST_NAME or not name.isprintable():
            raise RefusedError(f"A name has 1 to {LONGEST_NAME} characters on one line.")
        if name in self._names():
            raise RefusedError(f"There is a demonstration named '{name}' already.")
        made = self._take.demonstration(name, self._environment, self._bundle)
        self._file.save([document_of(d) for d in (*self.saved, made)])
        self.saved.append(made)
        self._episode += 1
        self._begin()
        self._score()
        return f"Saved '{name}', {counted(made.n_samples, 'sample')}."

    def _remove(self, name: str) -> str:
        kept = [d for d in self.saved if d.name != name]
        if len(kept) == len(self.saved):
            raise RefusedError(f"'{name}' was not recorded in this sitting.")
        self._file.save([document_of(d) for d in kept])
        self.saved = kept
        self._score()
        return f"Removed '{name}'."

    def close(self) -> str:
        """Save what is unsaved, let go of the environment; return an account of all that was saved.

        Raises: InputError: the file cannot be written; what was unsaved is then in a file that the message names.
        """
        self._world.close()
        note = ""
        if self.unsaved:
            name = self.proposed_name()
            made = self._take.demonstration(name, self._environment, self._bundle)
            try:
                self._file.save([document_of(d) for d in (*self.saved, made)])
            except InputError as error:
                place = self._file.rescue([document_of(made)])
                print_to = f"the unfinished demonstration is kept in {place}"
                raise type(error)([_with_help(d, print_to) for d in error.diagnostics]) from error
            self.saved.append(made)
            self._score()
            note = f" ('{name}' was unfinished)"
        if not self.saved:
            return "nothing was recorded"
        names = ", ".join(f"'{d.name}'" for d in self.saved)
        return f"saved {counted(len(self.saved), 'demonstration')} in {self._file.path}: {names}{note}"

    def _score(self) -> None:
        """Rank what was saved, together with what the file held before, as far as that can be scored."""
        self.ranking, self._trouble = None, ""
        if self._bundle is None or not self.saved:
            return
        older = self._file.existing if len(self._file.existing) <= _MOST_SCORED else ()
        for rows in ((*older, *self.saved), tuple(self.saved)):
            try:
                self.ranking = score(self._bundle, rows, self._environment)
                self._trouble = ""
                return
            except InputError as error:
                self._trouble = error.diagnostics[0].message

    def frame(self) -> Any:
        """Return what is to be seen, as `World.frame`."""
        return self._world.frame()

    def _known(self) -> Standings:
        if self._follower is not None:
            return self._follower.standings(self._take)
        names = self._environment.signal_names
        if not names:
            return Standings()
        columns = self._environment.signals(names, [self._take.moments[-1].state])
        return Standings(signals={name: values[-1].item() for name, values in columns.items()})

    def view(self) -> dict[str, Any]:
        """Return what the page shows, as data for JSON."""
        take = self._take
        return {
            "revision": self.revision,
            "state": take.moments[-1].state,
            "samples": len(take.moments),
            "path": [m.state for m in take.moments] if self._world.kind == "map" else [],
            "ended": take.ended,
            "name": self.proposed_name(),
            "signals": {name: number(value) for name, value in self._standings.signals.items()},
            "trouble": self._standings.trouble,
            "requirements": {
                name: {"low": number(s.low), "high": number(s.high), "current": number(s.current), "verdict": s.verdict}
                for name, s in self._standings.requirements.items()
            },
            "saved": [{"name": d.name, "samples": d.n_samples} for d in self.saved],
            "ranking": self._rows(),
            "ranking_trouble": self._trouble,
        }

    def _rows(self) -> list[dict[str, Any]]:
        if self.ranking is None:
            return []
        mine = {d.name for d in self.saved}
        rows = [self.ranking.demonstrations[k] for k in self.ranking.best_first()]
        return [
            {
                "name": row.name, "mine": row.name in mine, "label": row.label, "reward": row.reward, "rank": row.rank,
                "cells": [[x.result.verdict, value_text(x.result)] for x in row.requirements.values()],
                "reasons": [x.reason for x in row.requirements.values() if x.reason],
            }
            for row in rows
        ]  # fmt: skip

    def about(self) -> dict[str, Any]:
        """Return what does not change: the environment with its map and actions, the requirements, the file."""
        world, environment, bundle = self._world, self._environment, self._bundle
        names = environment.action_names
        first = world.first_action
        return {
            "kind": world.kind,
            "environment": environment.id,
            "map": list(environment.map) if world.kind == "map" and environment.map else [],
            "certain": environment.deterministic,
            "actions": [
                {"action": first + k, "name": names[k] if k < len(names) else f"action {first + k}"}
                for k in range(world.n_actions)
            ],
            "title": (bundle.title or bundle.name) if bundle is not None else None,
            "requirements": [
                {"name": r.name, "strength": r.strength, "doc": r.doc, "text": r.text, "scale": r.scale}
                for r in (bundle.requirements if bundle is not None else ())
            ],
            "file": str(self._file.path),
            "existing": len(self._file.existing),
        }


def _with_help(found: Any, words: str) -> Any:
    return type(found)(found.code, found.severity, found.message, file=found.file, help=f"{words}; {found.help}")
