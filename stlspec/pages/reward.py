"""The part of the report on the reward: what Algorithm 1 gives the states, on the map where there is one.

In: a spec, demonstrations, an environment. Out: a picture or a table of R(s), and the path of each demonstration on
the map; or the reason why there is none, for a report on scores is no less right without it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from stlspec.compiler.bundle import BundleData
from stlspec.compiler.printing import counted
from stlspec.demos import Demonstration
from stlspec.envs.model import Environment
from stlspec.errors import InputError
from stlspec.markup.elements import Markup, element, number
from stlspec.markup.grids import Board, board_svg
from stlspec.markup.tables import cell, table
from stlspec.rewards import ranked_states, reward_of
from stlspec.sampling import OnNan
from stlspec.scores import Ranking

_MOST_STATES = 30


@dataclass(frozen=True, slots=True)
class RewardView:
    """What there is to show: values of states by number, or the reason for none.

    paths: of each demonstration that was made on a map, by its number: the rows of the map and the cells.
    """

    reason: str = ""
    environment: Environment | None = None
    values: Mapping[int, float] = field(default_factory=dict)
    paths: Mapping[int, Board] = field(default_factory=dict)


def reward_view(
    bundle: BundleData,
    ranking: Ranking,
    demonstrations: Sequence[Demonstration],
    environment: Environment | None,
    on_nan: OnNan = "refuse",
    resample: int | None = None,
) -> RewardView:
    """Infer the reward, as far as the data allow.

    Paper: Algorithm 1. on_nan, resample: as the ranking was made. Returns: the values; or why there are none, in words.
    """
    if not demonstrations:
        return RewardView("There are no demonstrations to infer it from.")
    if ranking.at is not None or any(d.label is None for d in ranking.demonstrations):
        return RewardView("It is inferred from whole demonstrations whose labels are all decided.")
    try:
        # Most often all demonstrations lack states, or none does; so the first one tells at once.
        ranked_states(bundle, demonstrations[:1], environment, on_nan=on_nan, resample=resample)
        ranked = ranked_states(bundle, demonstrations, environment, on_nan=on_nan, resample=resample)
        reward = reward_of(bundle, ranked, environment)
    except InputError as error:
        found = error.diagnostics[0]
        return RewardView(f"None could be inferred: {found.message}.")
    if any((d.label, d.rank) != (r.label, r.rank) for d, r in zip(ranking.demonstrations, ranked, strict=True)):
        # The ranking was made of other samples, such as those left after `--on-nan drop`.
        return RewardView("The scores are not those of the samples as recorded, to which the states belong.")
    home = ranked[0].environment
    table_of = reward.table(home)
    paths = {
        k: Board(found.environment.map, path=found.states)
        for k, found in enumerate(ranked)
        if found.environment.map is not None and found.environment.n_columns
    }
    return RewardView("", home, {s: v for s, v in enumerate(table_of) if v}, paths)


def reward_section(view: RewardView) -> Markup:
    """Write the part on the reward."""
    return element(
        "section", element("h2", "Inferred reward", id="reward-heading"), *_contents(view),
        id="reward", aria_labelledby="reward-heading",
    )  # fmt: skip


def _contents(view: RewardView) -> list[Markup]:
    world = view.environment
    if world is None:
        return [element("p", view.reason, class_="lead")]
    if not view.values:
        return [
            element("p", "It is 0 in every state: these demonstrations say nothing about where to go.", class_="lead")
        ]
    if world.map is not None and world.n_columns:
        board = board_svg(Board(world.map, view.values), "The inferred reward on the map", 480)
        words = (
            f"R(s) of {counted(len(view.values), 'state')}, from {number(min(view.values.values()))} to "
            f"{number(max(view.values.values()))}; all others 0. Plain: positive; hatched: negative; filled squares: "
            "obstacles; ring: start; stars: goals"
        ) + ("; letters: regions." if any(letter.islower() for row in world.map for letter in row) else ".")
        return [element("figure", board, element("figcaption", words), class_="map")]
    return [_states(view)]


def _states(view: RewardView) -> Markup:
    best = sorted(view.values.items(), key=lambda pair: -abs(pair[1]))[:_MOST_STATES]
    rows = [[element("th", state, scope="row"), cell(number(value), kind="number")] for state, value in best]
    left = len(view.values) - len(best)
    return table(
        "R(s), the largest first" + (f"; {counted(left, 'state')} with smaller ones are left out" if left else ""),
        ["State", "Reward"], rows,
    )  # fmt: skip
