"""What each demonstration taught: its part of the reward, and the steps that it forbids.

In: the evidence of a run. Out: `Lessons`, kept beside the results as lessons.json, and from it, by itself, where
the reward of one state comes from. The sums are those of Algorithm 1, in the same order, so that an explanation
adds up to the last digit.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from stlspec.documents import DamageError, State, read_document, read_state
from stlspec.envs.model import Environment
from stlspec.errors import DataError, diagnostic
from stlspec.learning.evidence import Evidence, same_table, violating_pairs
from stlspec.learning.task import Task, place
from stlspec.rewards import RankedStates

SCHEMA = "stlspec.lessons/1"
FILE = "lessons.json"
_LARGEST_FILE = 256 * 2**20


@dataclass(frozen=True, slots=True)
class Forbidden:
    """A step that a bad demonstration showed to violate: the action in the state, and the state it leads to."""

    state: State
    action: str
    after: State


@dataclass(frozen=True, slots=True)
class Lesson:
    """What one demonstration taught.

    label, rank: as scored. length: its samples. values: r_j(s) for each state that gets one, with the last sample
    at which it is visited. forbids: steps. broken: the hard requirements that it violates.
    """

    name: str
    label: str
    rank: int
    length: int
    values: tuple[tuple[State, float, int], ...]
    forbids: tuple[Forbidden, ...]
    broken: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Lessons:
    """What all demonstrations of a run taught; `divisor` normalises their sum, 0 = there is none to normalise.

    given: whether the reward map was given instead, so that nothing is known about its values. memory: whether
    steps are forbidden after the same past only, since hard requirements remember it.
    """

    lessons: tuple[Lesson, ...]
    divisor: float
    given: bool
    memory: bool = False

    def to_json(self) -> dict[str, Any]:
        """Return the `stlspec.lessons/1` document."""
        return {
            "schema": SCHEMA,
            "given": self.given,
            "divisor": self.divisor,
            "memory": self.memory,
            "demonstrations": [
                {
                    "name": lesson.name,
                    "label": lesson.label,
                    "rank": lesson.rank,
                    "length": lesson.length,
                    "broken": list(lesson.broken),
                    "values": [[_listed(s), value, sample] for s, value, sample in lesson.values],
                    "forbids": [[_listed(f.state), f.action, _listed(f.after)] for f in lesson.forbids],
                }
                for lesson in self.lessons
            ],
        }


NO_LESSONS = Lessons((), 0.0, False)
"""What is taught where there are no demonstrations."""


@dataclass(frozen=True, slots=True)
class Source:
    """Where the reward of one state comes from.

    state, reward: R(s). terms: for each demonstration that gives it a value, the lesson, the value and the sample.
    divisor: as in `Lessons`. forbidden: the steps out of the state that are never taken. given: as in `Lessons`.
    """

    state: State
    reward: float
    terms: tuple[tuple[Lesson, float, int], ...]
    divisor: float
    forbidden: tuple[tuple[Lesson, Forbidden], ...]
    given: bool
    memory: bool = False

    def to_json(self) -> dict[str, Any]:
        """Return the `stlspec.source/1` document."""
        return {
            "schema": "stlspec.source/1",
            "state": _listed(self.state),
            "reward": self.reward,
            "divisor": self.divisor,
            "given": self.given,
            "terms": [
                {"demonstration": x.name, "label": x.label, "rank": x.rank, "value": value, "sample": sample}
                for x, value, sample in self.terms
            ],
            "forbidden": [
                {"demonstration": x.name, "action": f.action, "to": _listed(f.after)} for x, f in self.forbidden
            ],
        }


Broken = Callable[[Sequence[int]], tuple[str, ...]]
"""Names the hard requirements that a path of the environment's states violates."""


def lessons_of(
    evidence: Evidence, environment: Environment, task: Task | None = None, broken: Broken | None = None
) -> Lessons:
    """Work out what each demonstration taught.

    Paper: Algorithm 1; not in the paper: the mask.

    Args:    evidence: of the run. environment: learned in. task, broken: any task of the run, and what judges paths;
             None where transitions are by chance: then no step is forbidden.
    """
    ranked = evidence.ranked
    sums: dict[int, list[float]] = {}
    for demonstration in ranked:
        for state, value in demonstration.values.items():
            sums.setdefault(state, []).append(demonstration.rank * value)
    divisor = max((abs(math.fsum(terms)) for terms in sums.values()), default=0.0)
    found = tuple(_lesson(d, task, environment, broken) for d in ranked)
    return Lessons(found, divisor, evidence.given, task is not None and bool(task.places))


def _lesson(demonstration: RankedStates, task: Task | None, environment: Environment, broken: Broken | None) -> Lesson:
    home = demonstration.environment
    here = demonstration.label == "bad" and broken is not None and same_table(demonstration, environment)
    last = {state: sample for sample, state in enumerate(demonstration.states)}
    return Lesson(
        demonstration.name,
        demonstration.label,
        demonstration.rank,
        len(demonstration.states),
        tuple((_named(home, s), value, last[s]) for s, value in demonstration.values.items()),
        _forbidden(demonstration.states, task, environment) if here and task is not None else (),
        broken(demonstration.states) if here and broken is not None else (),
    )


def _forbidden(states: Sequence[int], task: Task, environment: Environment) -> tuple[Forbidden, ...]:
    names = environment.action_names
    return tuple(
        Forbidden(
            _named(environment, place(task, state)),
            names[action] if action < len(names) else str(action),
            _named(environment, place(task, task.transitions[state][action])),
        )
        for state, action in sorted(violating_pairs(task, states))
    )


def _named(environment: Environment, state: int) -> State:
    named = environment.decode(state)
    return tuple(named) if isinstance(named, list) else named


def _listed(state: State) -> Any:
    return list(state) if isinstance(state, tuple) else state


def source_of(lessons: Lessons, reward: float, state: State) -> Source:
    """Explain the reward of a state.

    Paper: Algorithm 1, read backwards: R(s) = sum of rank_j * r_j(s), divided by the largest sum.

    Args:    lessons: of a run. reward: R(s). state: as files have it.
    """
    terms = tuple((x, value, at) for x in lessons.lessons for s, value, at in x.values if s == state)
    forbidden = tuple((x, f) for x in lessons.lessons for f in x.forbids if f.state == state)
    return Source(state, reward, terms, lessons.divisor, forbidden, lessons.given, lessons.memory)


def explain(out: str | Path, state: State) -> Source:
    """Explain the reward of a state of a finished run; the run's own files are all that is read.

    Not in the paper: see `source_of`.

    Args:    out: the directory of the run. state: (row, column), or a number.
    Raises:  DataError D873: there is no finished run, or it is damaged; D874: the policy has no such state.
    """
    place_of = Path(out)
    try:
        policy = read_document(place_of / "policy.json", "stlspec.policy/1", _LARGEST_FILE)
        states = [read_state(s) for s in policy.get("states", [])]
        rewards = read_document(place_of / "reward.json", "stlspec.reward/1", _LARGEST_FILE)
        known = {read_state(s): float(v) for s, v in zip(rewards["states"], rewards["values"], strict=True)}
        lessons = _lessons(read_document(place_of / FILE, SCHEMA, _LARGEST_FILE))
    except (DamageError, KeyError, TypeError, ValueError, OverflowError) as error:
        problem = str(error) if isinstance(error, DamageError) else "one of its files is damaged"
        raise DataError([diagnostic("D873", file=str(out), problem=problem)]) from None
    if isinstance(state, int) and isinstance(next(iter(states), None), tuple) and 0 <= state < len(states):
        state = states[state]
    if state not in states:
        example = f"such as {_listed(states[0])}" if states else "none"
        shown = str(_listed(state))
        raise DataError([diagnostic("D874", observation=shown, states=len(states), example=example)])
    return source_of(lessons, known.get(state, 0.0), state)


def _lessons(document: dict[str, Any]) -> Lessons:
    lessons = tuple(
        Lesson(
            str(d["name"]),
            str(d["label"]),
            int(d["rank"]),
            int(d["length"]),
            tuple((read_state(s), float(value), int(sample)) for s, value, sample in d["values"]),
            tuple(Forbidden(read_state(s), str(action), read_state(after)) for s, action, after in d["forbids"]),
            tuple(map(str, d["broken"])),
        )
        for d in document["demonstrations"]
    )
    return Lessons(lessons, float(document["divisor"]), bool(document["given"]), bool(document["memory"]))
