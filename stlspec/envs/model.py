"""What the rest of the product knows about an environment, as data.

In: what a factory (`gridworld`, `frozenlake`, ...) found out about one environment. Out: `Environment`, which
numbers states, knows the deterministic transitions, and computes the signals that it offers. It never steps
anything: the learner runs on the table, and whoever needs the live environment makes it from `options`. That
keeps scoring free of side effects, and makes "the same environment" a comparison of data.
"""

import hashlib
import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from stlspec.envs.bins import Bins
from stlspec.errors import DataError, diagnostic

Outcomes: TypeAlias = tuple[tuple[tuple[tuple[float, int], ...], ...], ...]
Columns: TypeAlias = dict[str, npt.NDArray[Any]]
SignalFunction: TypeAlias = Callable[[Sequence[str], npt.NDArray[Any]], Columns]


def no_signals(_names: Sequence[str], _states: npt.NDArray[Any]) -> Columns:
    """Compute nothing: the signals of an environment that offers none."""
    return {}


@dataclass(frozen=True, eq=False)
class Environment:
    """One environment: its states, its transitions, and the signals it offers.

    id, args: as they were asked for. map: the rows of the map, also where only its name was given.
    n_states: 0 when states are raw observations. n_actions: 0 when unknown. start: the number of the state
    where episodes begin. n_columns: the width of the map, None when states are no cells.
    table: (n_states, n_actions) int64, the next state; None when transitions are stochastic or unknown.
    outcomes: for stochastic transitions that are known, [state][action] = ((probability, next state), ...).
    payoffs: what the environment pays for entering each state, () = unknown or nothing.
    deterministic: whether transitions are known to be. binned: whether states are bins of observations; then
    n_states is 0, since observations stay what signals are computed from, and `bins` numbers them.
    terminal: states at which the environment itself ends. max_steps: its step limit; None = no limit.
    signal_names: the signals it computes. state_signals: those that together are the state.
    compute: (names, states) -> columns; states are numbers, or raw observations when n_states is 0.
    options: the keyword arguments of `gymnasium.make(id, ...)`. module: what is imported before, to register the id.
    """

    id: str
    args: Mapping[str, Any] = field(default_factory=dict)
    map: tuple[str, ...] | None = None
    n_states: int = 0
    n_actions: int = 0
    start: int | None = None
    n_columns: int | None = None
    table: npt.NDArray[np.int64] | None = None
    outcomes: Outcomes | None = None
    payoffs: tuple[float, ...] = ()
    deterministic: bool = False
    binned: bool = False
    bins: Bins | None = None
    terminal: frozenset[int] = frozenset()
    max_steps: int | None = None
    action_names: tuple[str, ...] = ()
    signal_names: tuple[str, ...] = ()
    state_signals: tuple[str, ...] = ()
    compute: SignalFunction = no_signals
    options: Mapping[str, Any] = field(default_factory=dict)
    module: str | None = None

    @property
    def asked(self) -> str:
        """The id as it was asked for: MODULE:ID where a module registers it. Never what a file keeps."""
        return self.id if self.module is None else f"{self.module}:{self.id}"

    @cached_property
    def transitions(self) -> tuple[tuple[int, ...], ...] | None:
        """The next state for [state][action], as plain tuples for a fast loop; None without a table."""
        return None if self.table is None else tuple(map(tuple, self.table.tolist()))

    @property
    def size(self) -> int:
        """The number of states that have numbers: of bins, where observations are binned."""
        return self.n_states if self.bins is None else self.bins.size

    @cached_property
    def fingerprint(self) -> str | None:
        """A hash of what a state and an action mean here; None when transitions are not deterministic.

        Two environments with one fingerprint share the transition table and every signal, so what was learnt
        about a (state, action) pair in one holds in the other. Where episodes begin does not count.
        """
        if self.table is None:
            return None
        rows = None if self.map is None else [row.replace("S", ".").replace("F", ".") for row in self.map]
        head = json.dumps([self.id, rows, self.table.shape, sorted(self.terminal)])
        return hashlib.sha256(head.encode() + self.table.astype("<i8").tobytes()).hexdigest()

    def encode(self, state: Any) -> int:
        """Return the number of `state`, given as [row, col] or as a number, or as an observation to be binned.

        Raises: DataError D827: the environment has no such state; D828: its states have no numbers.
        """
        if self.bins is not None:
            return self._binned(state)
        self._require_numbers()
        number = _number(state, self.n_states, self.n_columns)
        if number is None:
            raise DataError([self._no_such(state, "")])
        return number

    def _binned(self, state: Any) -> int:
        assert self.bins is not None
        if type(state) is int and 0 <= state < self.bins.size:
            return state
        try:
            return self.bins.number(state)
        except (ValueError, TypeError, OverflowError):
            raise DataError([self._no_such(state, "")]) from None

    def encode_all(self, states: Iterable[Any] | npt.NDArray[Any], *, file: str | None = None) -> Any:
        """Return the numbers of `states` as int64, shape (n_samples,).

        Raises: DataError D827: naming the first sample whose state is none; D828 as for `encode`.
        """
        self._require_numbers(file)
        listed = states if isinstance(states, np.ndarray) else list(states)
        numbers = _numbers(listed, self.n_states, self.n_columns)
        if numbers is not None:
            return numbers
        slow = [_number(state, self.n_states, self.n_columns) for state in listed]
        if None in slow:
            sample = slow.index(None)
            raise DataError([self._no_such(listed[sample], f" (sample {sample})", file)])
        return np.array(slow, dtype=np.int64)

    def decode(self, number: int) -> Any:
        """Return what a file calls state `number`: [row, col] on a map, else the number."""
        if self.n_columns is None:
            return int(number)
        return list(divmod(int(number), self.n_columns))

    def signals(
        self, names: Iterable[str], states: Iterable[Any] | npt.NDArray[Any], *, file: str | None = None
    ) -> Columns:
        """Compute the signals `names` over a sequence of states.

        Args: names: some of `signal_names`. states: numbers or [row, col]; raw observations when n_states is
            0.
        Returns: for each name an array (n_samples,), float64 or bool.
        Raises: DataError D827: a state that the environment does not have.
        """
        if self.n_states:
            return self.compute(tuple(names), self.encode_all(states, file=file))
        return self.compute(tuple(names), self._observations(states, file))

    def describe(self) -> dict[str, Any]:
        """Return the form that demonstration and reward files keep: {"id", "args", "map"}, with "bins" if it has."""
        bins = {} if self.bins is None else {"bins": self.bins.to_json()}
        return {"id": self.id, "args": dict(self.args), "map": None if self.map is None else list(self.map), **bins}

    def _require_numbers(self, file: str | None = None) -> None:
        if not self.n_states:
            raise DataError([diagnostic("D828", file=file, id=self.id)])

    def _observations(self, states: Iterable[Any], file: str | None) -> npt.NDArray[np.float64]:
        listed = states if isinstance(states, np.ndarray) else list(states)
        width = len(self.state_signals)
        try:
            raw = np.asarray(listed, dtype=np.float64)
        except (TypeError, ValueError, OverflowError):
            raw = np.empty((0, 0))
        if raw.shape == (len(listed), width):
            return raw
        for sample, state in enumerate(listed):
            if not _is_vector(state, width):
                raise DataError([self._no_such(state, f" (sample {sample})", file)])
        return np.array(listed, dtype=np.float64).reshape(len(listed), width)

    def _no_such(self, state: Any, where: str, file: str | None = None) -> Any:
        if self.n_columns:
            rows = self.n_states // self.n_columns
            what = f"[row, col] with row 0 to {rows - 1} and col 0 to {self.n_columns - 1}"
        elif self.n_states:
            what = f"a number from 0 to {self.n_states - 1}"
        else:
            what = "[" + ", ".join(self.state_signals) + "]"
        return diagnostic(
            "D827",
            file=file,
            state=_shown(state),
            environment=f"'{self.id}'",
            where=where,
            help=f"a state is {what}",
        )


def derive_actions(environment: Environment, states: npt.ArrayLike) -> tuple[int | None, ...] | None:
    """Find the action between each state and the next; the lowest one where several lead there.

    Paper: demonstrations are sequences of states; Algorithms 2 and 3 need state and action.

    Args:    states: (n_samples,), numbers of states of `environment`.
    Returns: n_samples - 1 actions, None where none leads there; None without a deterministic table.
    """
    if environment.table is None:
        return None
    numbers = np.asarray(states, dtype=np.int64)
    leads = environment.table[numbers[:-1]] == numbers[1:, None]
    found = np.where(leads.any(axis=1), leads.argmax(axis=1), -1)
    return tuple(None if action < 0 else action for action in found.tolist())


def _shown(value: Any) -> str:
    text = repr(value.tolist() if isinstance(value, np.ndarray | np.generic) else value)
    return text if len(text) <= 40 else text[:37] + "..."


def _whole(value: Any) -> int | None:
    if isinstance(value, np.generic):
        value = value.item()
    if type(value) not in (int, float):
        return None
    # A float is taken when it is a whole number: arrays and CSV columns hold states as floats.
    return int(value) if abs(value) < 2**53 and value == int(value) else None


def _number(state: Any, n_states: int, n_columns: int | None) -> int | None:
    if isinstance(state, np.ndarray):
        state = state.tolist()
    if isinstance(state, list | tuple) and len(state) == 2 and n_columns:
        row, column = _whole(state[0]), _whole(state[1])
        if row is None or column is None or not 0 <= column < n_columns:
            return None
        number: int | None = row * n_columns + column
    else:
        number = _whole(state)
    return number if number is not None and 0 <= number < n_states else None


def _numbers(
    states: list[Any] | npt.NDArray[Any], n_states: int, n_columns: int | None
) -> npt.NDArray[np.int64] | None:
    """Number many states at once; None when one of them needs a closer look."""
    try:
        array = np.asarray(states)
    except (ValueError, OverflowError):
        return None
    if array.dtype.kind not in "iuf" or not len(array) or not np.all(np.abs(array) < 2**53):
        return None
    numbers = array.astype(np.int64)
    if not np.array_equal(numbers, array):
        return None
    if numbers.ndim == 2 and numbers.shape[1] == 2 and n_columns:
        row, column = numbers[:, 0], numbers[:, 1]
        if not np.all((column >= 0) & (column < n_columns)) or not np.all(np.abs(row) <= n_states):
            return None
        numbers = row * n_columns + column
    return numbers if numbers.ndim == 1 and np.all((numbers >= 0) & (numbers < n_states)) else None


def _is_vector(state: Any, width: int) -> bool:
    try:
        return bool(np.asarray(state, dtype=np.float64).shape == (width,))
    except (TypeError, ValueError, OverflowError):
        return False
