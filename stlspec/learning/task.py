"""What there is to learn: goals and hard requirements as tables over the states that the learner tells apart.

In: a compiled spec and an environment. Out: `Task`. A condition that looks at the present sample only has one
value in each state, so it is evaluated once, over a trace that visits every state, and training looks it up.
A *learner state* is a state of the environment together with what the hard requirements remember of the way
there; without memory it is the environment's own state. Training sees nothing but the numbers of these
states; `Task.places` and `lifted` lead from one numbering to the other.
Whatever does not fit that form (several goals, hard requirements with memory, chance) is refused here, before
any training.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from stlspec.compiler.bundle import BundleData, Requirement
from stlspec.compiler.ir import COMPARISONS, TEMPORAL, Node, reachable
from stlspec.compiler.printing import expression_text
from stlspec.envs.model import Environment
from stlspec.errors import UsageError, diagnostic
from stlspec.learning.shaping import GOAL, RUNS, TERMINAL, VIOLATION
from stlspec.semantics.robustness import evaluate_nodes, shown
from stlspec.traces import make_trace

MOST_STATES = 100_000

_WITH_MEMORY = TEMPORAL | {"now", "delta", "rate"}
_FLIPPED = {"not"}
_KEPT = {"and", "or"} | TEMPORAL


@dataclass(frozen=True, slots=True, order=True)
class Condition:
    """A formula over the present sample: the node of the formula DAG, or its negation."""

    node: int
    negated: bool = False


@dataclass(frozen=True, slots=True)
class Task:
    """Tables over learner states, row = number of the state.

    goal_name: what the goal is called in the spec. start: the state that episodes begin in.
    transitions: (n_states, n_actions), the next states. endings: (n_states,), how an episode stands in each
    state: it violates a hard requirement, else is a goal, else is terminal in the environment, else runs on.
    robustness: (n_states, n_hard), of the condition that each hard requirement demands always.
    places: (n_states,), the state of the environment in each; () = they are the environment's own states.
    stream: what tells the random numbers of this task from those of other tasks of one run.
    """

    goal_name: str
    n_states: int
    n_actions: int
    start: int
    transitions: tuple[tuple[int, ...], ...]
    endings: tuple[int, ...]
    robustness: tuple[tuple[float, ...], ...]
    places: tuple[int, ...] = ()
    stream: tuple[int, ...] = ()


Value = TypeVar("Value")


def lifted(task: Task, values: Sequence[Value]) -> tuple[Value, ...]:
    """Carry a table over the environment's states, such as a reward map, to learner states.

    Not in the paper: it bridges the two numberings.

    Args:    values: one for each state of the environment.
    Returns: (n_states,) of the task.
    """
    return tuple(values[place] for place in task.places) if task.places else tuple(values)


def place(task: Task, state: int) -> int:
    """Return the state of the environment that a learner state is in. Not in the paper: see `lifted`."""
    return task.places[state] if task.places else state


def followed(task: Task, states: Sequence[int]) -> tuple[int | None, ...]:
    """Find the learner states that a recording passes through.

    Not in the paper: a bad demonstration masks a step of the learner, memory included.

    Args:    states: of the environment, (n_samples,).
    Returns: (n_samples,); None from the first sample on that the learner could not have reached: the
             recording begins elsewhere, jumps, or goes on after an end.
    """
    if not task.places:
        return tuple(states)
    found: list[int | None] = []
    state = task.start if states and states[0] == task.places[task.start] else None
    for sample, here in enumerate(states):
        if sample and state is not None:
            ahead = task.transitions[state] if task.endings[state] != VIOLATION else ()
            state = next((after for after in ahead if task.places[after] == here), None)
        found.append(state)
    return tuple(found)


def momentary(nodes: Sequence[Node]) -> tuple[bool, ...]:
    """Tell for each node whether its value depends on the present sample alone.

    Not in the paper: it defines which formulas are predicates over states.

    Returns: (n_nodes,), False where a temporal operator, delta, rate or now stands in the node or below it.
    """
    found: list[bool] = []
    for node in nodes:
        found.append(node.op not in _WITH_MEMORY and all(found[child] for child in node.children))
    return tuple(found)


def find_goals(bundle: BundleData) -> tuple[Condition, ...]:
    """Collect the state predicates that some requirement wants to hold eventually.

    Paper: the set Goals of Algorithms 2 and 3, which the paper takes as given.

    A negated `always p` counts as `eventually not p`, and a negated `eventually p` wants p never.

    Returns: the distinct conditions, in the order of the formula DAG.
    """
    simple = momentary(bundle.nodes)
    goals = set()
    for index, negated in sorted(_polarities(bundle)):
        node = bundle.nodes[index]
        if node.op == ("always" if negated else "eventually") and simple[node.children[0]]:
            goals.add(Condition(node.children[0], negated))
    return tuple(sorted(goals))


def _polarities(bundle: BundleData) -> set[tuple[int, bool]]:
    """Return (node, negated) for each formula node as it occurs under an even or odd number of negations."""
    found: set[tuple[int, bool]] = set()
    stack = [(r.root, False) for r in bundle.requirements]
    while stack:
        index, negated = stack.pop()
        if (index, negated) in found:
            continue
        found.add((index, negated))
        node = bundle.nodes[index]
        if node.op in _FLIPPED or node.op in _KEPT:
            stack.extend((child, negated != (node.op in _FLIPPED)) for child in node.children)
    return found


def step_conditions(bundle: BundleData, requirement: Requirement) -> tuple[Condition, ...]:
    """Find the conditions that a hard requirement demands of every sample on its own.

    Paper: hard requirements "typically have the form always(phi)"; Algorithm 2 watches them step by step.

    Returns: the conditions; all of them hold at every sample exactly if the requirement holds.
    Raises:  UsageError D868: it is not `always` of conditions over the present sample.
    """
    simple = momentary(bundle.nodes)
    found: list[Condition] = []
    stack = [(requirement.root, False)]
    while stack:
        index, negated = stack.pop()
        node = bundle.nodes[index]
        if node.op == "not":
            stack.append((node.children[0], not negated))
        elif node.op == ("or" if negated else "and") and not simple[index]:
            stack.extend((child, negated) for child in reversed(node.children))
        elif node.op == ("eventually" if negated else "always") and simple[node.children[0]]:
            if node.interval not in (None, (0, None)):
                raise _not_step_wise(requirement, f"its `{node.op}` has bounds")
            found.append(Condition(node.children[0], negated))
        else:
            raise _not_step_wise(requirement, _why(node))
    return tuple(found)


def _why(node: Node) -> str:
    if node.op in ("always", "eventually"):
        return f"an operator such as delta, now or `eventually` stands inside its `{node.op}`"
    if node.op in TEMPORAL:
        return f"it is built with `{node.op}`"
    return (
        "it is about the first sample only"
        if node.op in COMPARISONS or node.op == "bool"
        else (f"part of it, under `{node.op}`, is not under an `always`")
    )


def _not_step_wise(requirement: Requirement, reason: str) -> UsageError:
    return UsageError([diagnostic("D868", requirement=requirement.name, reason=reason)])


def make_task(bundle: BundleData, environment: Environment) -> Task:
    """Turn goals and hard requirements into tables over the states of an environment.

    Paper: the tests in Algorithm 2, line 13 ("s' in Goals or rho < 0 for any hard phi").

    Args:    bundle: the compiled spec. environment: with deterministic transitions over numbered states.
    Returns: the task.
    Raises:  UsageError D866, D867: no goal, or several; D868: a hard requirement with memory;
             D869: transitions are not known to be deterministic; D870: a signal is not offered;
             D876: the spec measures stamps.
    """
    if bundle.time.kind == "stamps":
        raise UsageError([diagnostic("D876", file=bundle.sources[0][0] if bundle.sources else None)])
    transitions = deterministic_transitions(environment)
    goals = find_goals(bundle)
    if not goals:
        raise UsageError([diagnostic("D866", file=bundle.sources[0][0] if bundle.sources else None)])
    if len(goals) > 1:
        shown = ", ".join(goal_name(bundle, goal) for goal in goals)
        raise UsageError([diagnostic("D867", count=len(goals), goals=shown)])
    hard = [step_conditions(bundle, r) for r in bundle.requirements if r.strength == "hard"]
    conditions = [goals[0], *(c for row in hard for c in row)]
    values, holds = tabulate(bundle, conditions, environment)
    violating = [not all(holds[c][s] for row in hard for c in row) for s in range(environment.n_states)]
    robustness = zip(*(map(min, zip(*(values[c] for c in row), strict=True)) for row in hard), strict=True)
    assert environment.start is not None
    return Task(
        goal_name(bundle, goals[0]),
        environment.n_states,
        environment.n_actions,
        environment.start,
        transitions,
        _endings(violating, holds[goals[0]], environment.terminal),
        tuple(robustness) if hard else ((),) * environment.n_states,
    )


def _endings(violating: Sequence[bool], goal: Sequence[bool], terminal: frozenset[int]) -> tuple[int, ...]:
    """Say how an episode stands in each state; a goal that violates is a violation."""
    return tuple(
        VIOLATION if bad else GOAL if wanted else TERMINAL if state in terminal else RUNS
        for state, (bad, wanted) in enumerate(zip(violating, goal, strict=True))
    )


def deterministic_transitions(environment: Environment) -> tuple[tuple[int, ...], ...]:
    """Return the next state for [state][action].

    Not in the paper: it says what the tabular learner needs of an environment.

    Raises:  UsageError D869: transitions are by chance, unknown, between bins, or between too many states.
    """
    transitions = environment.transitions
    reason, way_out = "", "learn in stlspec/GridWorld-v0 or FrozenLake-v1 --env-arg is_slippery=false"
    if environment.binned or not environment.n_states:
        reason = "its states are continuous, and learning over bins is not supported yet"
    elif environment.outcomes is not None:
        reason = "its transitions are by chance, and the learner takes deterministic ones"
        way_out = "--env-arg is_slippery=false, if it takes that"
    elif transitions is None or not environment.deterministic or environment.start is None:
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
    needed = {str(n.value) for n in reachable(bundle.nodes, roots)[0] if n.op in ("signal", "bool")}
    offered = signal_sources(bundle, needed, environment)
    columns = environment.signals(set(offered.values()), range(environment.n_states))
    trace = make_trace(
        bundle.time,
        bundle.signals,
        {name: columns[source] for name, source in offered.items()} or {"": np.zeros(environment.n_states)},
        required=needed,
        file=f"the states of {environment.id}",
    )
    values, holds = {}, {}
    for condition, raw in zip(conditions, evaluate_nodes(bundle.nodes, roots, trace), strict=True):
        signed = -raw if condition.negated else raw
        values[condition] = shown(signed).tolist()
        holds[condition] = (signed > 0).tolist()
    return values, holds


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


def goal_name(bundle: BundleData, goal: Condition) -> str:
    """Return what the spec calls a goal: the name of its `let`, else its formula."""
    named = [name for name, node in bundle.names.items() if node == goal.node]
    text = named[0] if named else expression_text(bundle.nodes, goal.node)
    return f"not ({text})" if goal.negated else text
