"""The goals of a task and the orders in which they may be visited.

In: the wishes and guards of a spec, and in which states of an environment their conditions hold. Out: `Visit`s,
wishes that the same states fulfil taken together, and all orders that nesting, `not b until a` and the
dependencies of requirements leave. Nesting is about meaning; where it contradicts the others, it wins.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from stlspec.compiler.bundle import BundleData
from stlspec.errors import UsageError, diagnostic
from stlspec.learning.goals import Agenda, Condition, Conditions, condition_name

MOST_ORDERS = 720
"""All orders of six goals."""

_MOST_COUNTED = 16
"""Goals up to which orders are counted exactly: the count looks at all subsets."""

Holds = Mapping[Condition, Sequence[bool]]
"""For each condition whether it holds, (n_states,) of the environment."""


@dataclass(frozen=True, slots=True)
class Visit:
    """A goal: states of which one is to be visited.

    holds: (n_states,) of the environment. earliest: the first tick that counts. requirements: the numbers of
    those that want it. before: the numbers of the visits that come before it, by whatever rule.
    """

    name: str
    holds: tuple[bool, ...]
    earliest: int
    requirements: frozenset[int]
    before: frozenset[int]


def together(holds: Holds, conditions: Conditions) -> tuple[bool, ...]:
    """Tell in which states all of several conditions hold. Returns: (n_states,)."""
    return tuple(map(all, zip(*(holds[c] for c in conditions), strict=True)))


def make_visits(bundle: BundleData, agenda: Agenda, holds: Holds) -> tuple[Visit, ...]:
    """Turn wishes into goals, each with what comes before it.

    Paper: the set Goals of Algorithm 3 and, in its section 3.2, "some specifications can require the robot to
    achieve the goals in a particular sequential order".

    Wishes that hold in the same states are one goal, unless something lies between them (a, then b, then a).
    A wish that no state fulfils is left out where there are others.

    Returns: the goals, in the order of the wishes.
    """
    tables = [together(holds, wish.conditions) for wish in agenda.wishes]
    if any(map(any, tables)):
        kept = [i for i, table in enumerate(tables) if any(table)]
    else:
        kept = list(range(min(1, len(tables))))
    found: list[list[int]] = []
    member: dict[int, int] = {}
    order = _Order()
    for i in kept:
        wish = agenda.wishes[i]
        above = [member[w] for w in wish.after if w in member]
        number = _same(agenda, tables, found, i, above, order)
        if number is None:
            number = len(found)
            found.append([])
        found[number].append(i)
        member[i] = number
        for other in above:
            order.add(other, number)
    wanted = [frozenset(agenda.wishes[w].requirement for w in group) for group in found]
    needed = [frozenset(agenda.wishes[w].requirement for w in g if agenda.wishes[w].certain) for g in found]
    _add_guards(agenda, holds, [(tables[g[0]], agenda.wishes[g[0]].earliest) for g in found], order)
    _add_dependencies(bundle, wanted, needed, order)
    return tuple(
        Visit(
            condition_name(bundle, agenda.wishes[group[0]].conditions),
            tables[group[0]],
            agenda.wishes[group[0]].earliest,
            wanted[number],
            frozenset(order.before(number)),
        )
        for number, group in enumerate(found)
    )


class _Order:
    """A strict partial order that grows by pairs; a pair that contradicts it is left out."""

    def __init__(self) -> None:
        self._above: dict[int, set[int]] = {}

    def before(self, number: int) -> set[int]:
        """Return all that comes before."""
        return self._above.get(number, set())

    def add(self, first: int, second: int) -> None:
        """Let `first` come before `second`, with all that this implies."""
        if first == second or second in self.before(first):
            return
        fresh = {first, *self.before(first)}
        for number in [second, *(n for n, above in self._above.items() if second in above)]:
            self._above.setdefault(number, set()).update(fresh)


def _same(
    agenda: Agenda,
    tables: Sequence[tuple[bool, ...]],
    found: Sequence[Sequence[int]],
    wish: int,
    above: Sequence[int],
    order: _Order,
) -> int | None:
    """Find the goal that a wish is the same as; not one that something else must lie between."""
    between = {n for number in above for n in order.before(number)} | set(above[:-1])
    for number, group in enumerate(found):
        equal = tables[group[0]] == tables[wish] and agenda.wishes[group[0]].earliest == agenda.wishes[wish].earliest
        if equal and number not in between:
            return number
    return None


def _add_guards(agenda: Agenda, holds: Holds, goals: Sequence[tuple[tuple[bool, ...], int]], order: _Order) -> None:
    """`not b until a`: what is kept up until a excludes every state of b, so that a comes first."""
    for guard in agenda.guards:
        if not guard.until:
            continue
        keep, until = together(holds, guard.keep), together(holds, guard.until)
        firsts = [(earliest, n) for n, (goal, earliest) in enumerate(goals) if goal == until]
        for number, (goal, _) in enumerate(goals):
            open_to = any(g and (k or u) for g, k, u in zip(goal, keep, until, strict=True))
            if firsts and any(goal) and not open_to:
                order.add(min(firsts)[1], number)


def _add_dependencies(
    bundle: BundleData, wanted: Sequence[frozenset[int]], needed: Sequence[frozenset[int]], order: _Order
) -> None:
    """A goal comes first if each requirement that wants the other depends on one that cannot do without it."""
    numbers = {r.name: i for i, r in enumerate(bundle.requirements)}
    above: list[set[int]] = [set() for _ in bundle.requirements]
    pending = [(i, numbers[p]) for i, r in enumerate(bundle.requirements) for p in r.depends_on]
    while pending:
        lower, upper = pending.pop()
        if upper not in above[lower]:
            above[lower].add(upper)
            pending += [(lower, numbers[p]) for p in bundle.requirements[upper].depends_on]
    for first, firsts in enumerate(needed):
        for second, seconds in enumerate(wanted):
            if first != second and all(firsts & above[r] for r in seconds):
                order.add(first, second)


def count_orders(visits: Sequence[Visit]) -> int:
    """Count the orders of all goals that their rules leave.

    Paper: section 3.2, "the number of ways to achieve this is k!"; "partial ordering helps".

    Returns: the exact number up to 16 goals.
    """
    before = [sum(1 << b for b in visit.before) for visit in visits]
    ways = {0: 1}
    for _ in visits:
        further: dict[int, int] = {}
        for done, count in ways.items():
            for number, needed in enumerate(before):
                if not done >> number & 1 and needed & ~done == 0:
                    further[done | 1 << number] = further.get(done | 1 << number, 0) + count
        ways = further
    return sum(ways.values())


def check_orders(visits: Sequence[Visit]) -> None:
    """Refuse a task with too many orders.

    Not in the paper: a limit.

    Raises:  UsageError D867: with the number of goals and of orders.
    """
    count = f"{count_orders(visits):,}" if len(visits) <= _MOST_COUNTED else f"over {MOST_ORDERS:,}"
    if len(visits) > _MOST_COUNTED or int(count.replace(",", "")) > MOST_ORDERS:
        goals = ", ".join(visit.name for visit in visits)
        raise UsageError(
            [diagnostic("D867", count=len(visits), goals=goals[:300], orders=count, most=f"{MOST_ORDERS:,}")]
        )


def next_goals(visits: Sequence[Visit], done: Sequence[int]) -> Iterator[int]:
    """Yield the goals that may follow on those already visited, ascending."""
    for number, visit in enumerate(visits):
        if number not in done and visit.before <= set(done):
            yield number
