"""The account of a run for people, line by line: what the demonstrations taught, the way on the map, the sources.

In: an `Outcome`, or the `Source` of one state. Out: plain lines; who prints them adds colours.
"""

from collections.abc import Sequence

from stlspec.compiler.printing import counted
from stlspec.documents import State
from stlspec.envs.model import Environment
from stlspec.learning.lessons import Lesson, Lessons, Source
from stlspec.learning.outcome import Outcome

_MOST_DEMONSTRATIONS = 12
_MOST_STEPS = 3


def taught(outcome: Outcome) -> list[str]:
    """Say of each demonstration, best first, how it shaped the reward or what it forbids.

    Not in the paper: the account.
    """
    lessons = sorted(outcome.lessons.lessons, key=lambda lesson: -lesson.rank)
    width = max((len(x.label) for x in lessons), default=0)
    lines = [
        f"  rank {x.rank}  {x.label:{width}}  {x.name}: {_effect(x, outcome.lessons)}"
        for x in lessons[:_MOST_DEMONSTRATIONS]
    ]
    if len(lessons) > _MOST_DEMONSTRATIONS:
        lines.append(f"  and {len(lessons) - _MOST_DEMONSTRATIONS} more")
    unused = {"plain": " (the method plain uses only what they forbid)", "paper": "", "shaped": ""}[outcome.method]
    return [f"What the demonstrations taught{unused}:", *lines] if lines else []


def _effect(lesson: Lesson, lessons: Lessons) -> str:
    if lesson.label == "bad":
        broken = f"breaks {', '.join(lesson.broken)}" if lesson.broken else "breaks a hard requirement"
        steps = [f"{f.action} from {_shown(f.state)}" for f in lesson.forbids[:_MOST_STEPS]]
        more = len(lesson.forbids) - len(steps)
        steps += [f"{more} more"] if more else []
        past = " after the same past" if lessons.memory else ""
        return f"{broken}; forbids {', '.join(steps)}{past}" if steps else f"{broken}; forbids nothing here"
    positive = [(value, state) for state, value, _ in lesson.values if value > 0]
    if not positive:
        return "is worth no reward"
    value, state = max(positive, key=lambda pair: pair[0])
    share = lesson.rank * value / lessons.divisor if lessons.divisor else 0.0
    return f"leads through {counted(len(positive), 'state')}, adding up to {share:.2f} at {_shown(state)}"


def _shown(state: State) -> str:
    return str(list(state)) if isinstance(state, tuple) else str(state)


def way_on_map(environment: Environment, states: Sequence[int]) -> list[str]:
    """Draw a path on the rows of a map: o where it goes, in a zone its letter as a capital; [] without a map.

    Not in the paper: its figures, in text.
    """
    if environment.map is None or environment.n_columns is None:
        return []
    rows = [list(row) for row in environment.map]
    on_lake = environment.id.startswith("FrozenLake")
    for state in states:
        row, column = divmod(state, environment.n_columns)
        cell = rows[row][column]
        rows[row][column] = "o" if cell in ".F" else cell if on_lake else cell.upper()
    return ["  " + " ".join(row) for row in rows]


def sources(source: Source) -> list[str]:
    """Say where the reward of a state comes from.

    Paper: Algorithm 1, for one state.
    """
    lines = [f"state {_shown(source.state)}: reward {source.reward:.6g}"]
    if source.given:
        lines.append("the run was given a reward map; where its values come from, the run that inferred it knows")
    elif not source.terms:
        lines.append("no demonstration gives it a value")
    else:
        sums = " + ".join(f"{x.rank} * {value:.6g}" for x, value, _ in source.terms)
        lines.append(f"= ({sums}) / {source.divisor:.6g}, the largest such sum of any state")
        lines += [_term(*term) for term in source.terms]
    past = " after the same past" if source.memory else ""
    for lesson, step in source.forbidden:
        why = f"which breaks {_broken(lesson)} in '{lesson.name}'"
        lines.append(f"forbidden{past}: {step.action} to {_shown(step.after)}, {why}")
    return lines


def _broken(lesson: Lesson) -> str:
    return ", ".join(lesson.broken) or "a hard requirement"


def _term(lesson: Lesson, value: float, sample: int) -> str:
    if lesson.label == "bad":
        return f"  rank {lesson.rank} '{lesson.name}', bad: {value:.6g} where it breaks {_broken(lesson)}"
    length = lesson.length
    whole = f"{sample + 1}/{length} of what the demonstration is worth"
    return f"  rank {lesson.rank} '{lesson.name}', {lesson.label}: {value:.6g} at sample {sample}, {whole}"
