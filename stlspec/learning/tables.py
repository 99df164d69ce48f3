"""Conditions as tables: over the states of an environment, over its steps, and over time.

In: a compiled spec, some of its conditions, an environment. Out: where they hold. Every value comes from the
evaluator of the spec, over traces that are made up of the states in question, so that learning and scoring
mean the same. Whatever does not fit the tabular learner is refused here, before any training.
"""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from stlspec.compiler.bundle import BundleData
from stlspec.compiler.ir import reachable
from stlspec.envs.model import Environment
from stlspec.errors import UsageError, diagnostic
from stlspec.learning.goals import Condition
from stlspec.semantics.robustness import evaluate_nodes, shown
from stlspec.traces import Trace, make_trace

MOST_STATES = 100_000

Step = tuple[int, int]
"""Two states of the environment, one after the other."""


def deterministic_transitions(environment: Environment) -> tuple[tuple[int, ...], ...]:
    """Return the next state for [state][action].

    Not in the paper: it says what the tabular learner needs of an environment.

    Raises:  UsageError D869: transitions are by chance, unknown, between bins, or between too many states.
    """
    transitions = environment.transitions
    reason, way_out = "", "learn in stlspec/GridWorld-v0 or FrozenLake-v1 --env-arg is_slippery=false"
    if transitions is None or not environment.deterministic or environment.start is None:
        reason = "its transitions are not known"
    elif environment.n_states > MOST_STATES:
        reason = f"it has {environment.n_states} states, and a table holds {MOST_STATES} at most"
    if reason or transitions is None:
        raise UsageError([diagnostic("D869", env=environment.id, reason=reason, help=way_out)])
    return transitions


def tabulate(
    bundle: BundleData, conditions: Sequence[Condition], environment: Environment
) -> tuple[dict[Condition, list[float]], dict[Condition, list[bool]]]:
    """Evaluate conditions in every state, over a trace that visits each once.

    Not in the paper: over finitely many states every predicate is a table.

    Returns: for each condition its robustness (n_states,), ties as 0, and whether it holds (n_states,).
    Raises:  UsageError D870: the environment does not offer a signal; DataError: an expression has no value.
    """
    roots = [condition.node for condition in conditions]
    trace = _trace(bundle, roots, environment, np.arange(environment.n_states))
    values, holds = {}, {}
    for condition, raw in zip(conditions, evaluate_nodes(bundle.nodes, roots, trace), strict=True):
        signed = -raw if condition.negated else raw
        values[condition] = shown(signed).tolist()
        holds[condition] = (signed > 0).tolist()
    return values, holds


def over_steps(
    bundle: BundleData, roots: Sequence[int], environment: Environment, steps: Sequence[Step]
) -> list[list[bool]]:
    """Tell for conditions with `delta` or `rate` whether they hold after a step.

    Not in the paper: what changed depends on two states.

    Args:    roots: nodes that look one sample back. steps: (n_steps,) pairs of states.
    Returns: for each root (n_steps,).
    """
    trace = _trace(bundle, roots, environment, np.array(steps, dtype=np.int64).reshape(-1, 2))
    return [(values[1] > 0).tolist() for values in evaluate_nodes(bundle.nodes, roots, trace)]


def over_time(
    bundle: BundleData, roots: Sequence[int], environment: Environment, last: int
) -> list[npt.NDArray[np.bool_]]:
    """Tell for conditions with `now` whether they hold in each state at each time.

    Not in the paper: time as part of the state.

    Args:    last: the last sample.
    Returns: for each root (last + 1, n_states).
    """
    states = np.repeat(np.arange(environment.n_states)[:, None], last + 1, axis=1)
    trace = _trace(bundle, roots, environment, states)
    return [np.asarray(values > 0) for values in evaluate_nodes(bundle.nodes, roots, trace)]


def _trace(bundle: BundleData, roots: Sequence[int], environment: Environment, states: npt.NDArray[np.int64]) -> Trace:
    """Return a trace through `states`, (n_samples,) or a batch (n_traces, n_samples)."""
    needed = {str(n.value) for n in reachable(bundle.nodes, roots)[0] if n.op in ("signal", "bool")}
    offered = signal_sources(bundle, needed, environment)
    columns = environment.signals(set(offered.values()), states.reshape(-1))
    return make_trace(
        bundle.time,
        bundle.signals,
        {name: columns[source].reshape(states.shape) for name, source in offered.items()}
        or {"": np.zeros(states.shape)},
        required=needed,
        file=f"the states of {environment.id}",
    )


def signal_sources(bundle: BundleData, needed: set[str], environment: Environment) -> dict[str, str]:
    """Find what the environment calls each signal: by `from "NAME"`, else by the signal's own name.

    Not in the paper: names. Where a spec says `from`, its own name counts for nothing, as when data are scored.

    Raises:  UsageError D870: it does not offer one of them.
    """
    found: dict[str, str] = {}
    for signal in bundle.signals:
        if signal.name not in needed:
            continue
        source = signal.source or signal.name
        if source not in environment.signal_names:
            offered = ", ".join(environment.signal_names) or "no signals"
            spec = f"spec '{bundle.name}'" if bundle.name else "the spec"
            user = f"signal '{signal.name}' of {spec}" if signal.source else spec
            raise UsageError([diagnostic("D870", env=environment.id, signal=source, user=user, offered=offered)])
        found[signal.name] = source
    return found
