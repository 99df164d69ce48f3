"""Which part of a demonstration shapes which segment."""

import pytest

from stlspec.learning import learn
from stlspec.learning.guidance import Way, part_of, segment_reward, ways_of
from stlspec.rewards import ranked_states

TOUR = (0, 1, 2, 1, 3, 4)
"""From the start 0 to a goal at 2, back over 1, and on to a goal at 4."""


def goal(*states):
    return [state in states for state in range(6)]


@pytest.mark.parametrize(
    ("start", "wanted", "part"),
    [
        (0, (2,), (0, 1, 2)),
        (2, (4,), (2, 1, 3, 4)),
        (0, (4,), (0, 1, 2, 1, 3, 4)),
        (5, (4,), (0, 1, 2, 1, 3, 4)),  # the start is not on it, so the whole way there may help
        (1, (4,), (1, 3, 4)),  # from the last visit of the start
        (1, (2,), (1, 2)),  # but not from one after which the goal does not come
        (4, (2,), (0, 1, 2)),
        (0, (5,), ()),
        (0, (2, 3), (0, 1, 2)),  # the first state of the goal that comes
    ],
)
def test_the_part_leads_from_the_start_to_the_goal(start, wanted, part):
    assert tuple(part_of(TOUR, start, goal(*wanted))) == part


def test_a_part_rises_to_what_the_whole_is_worth():
    """By hand: two ways to state 2, ranks 2 and 1, worth 0.5 and 0.8: sums 1/3, 2/3 + 0.4, 1 + 0.8."""
    found = segment_reward([Way(TOUR, 2, 0.5), Way((1, 2, 5), 1, 0.8)], 0, goal(2))
    assert found == pytest.approx(tuple(x / 1.8 for x in (1 / 3, 2 / 3 + 0.4, 1.8, 0, 0, 0)))


def test_nothing_leads_where_nobody_went():
    assert segment_reward([Way(TOUR, 2, 0.5)], 0, goal(5)) == (0.0,) * 6
    assert segment_reward([], 0, goal(2)) == (0.0,) * 6


def test_bad_demonstrations_lead_nowhere(kit):
    bundle, world, demos = kit.tour_parts(kit.public_items("grid-two-goal")[0])
    ranked = ranked_states(bundle, demos, world)
    ways = ways_of(ranked, world)
    assert [way.states for way in ways] == [d.states for d in ranked if d.label != "bad"]
    assert all(way.reward == max(d.values.values()) for way, d in zip(ways, ranked, strict=False))


def test_demonstrations_shorten_the_learning_of_tours(kit):
    """Over eight maps: training takes fewer steps in all, since it walks shorter ways from the beginning."""
    ratios = []
    for number in range(8):
        task = kit.random_tour(10, 2, f"guide{number}")
        shaped, plain = (learn(*task, method=m, episodes=300, seed=number) for m in ("shaped", "plain"))
        ratios.append(plain.training.env_steps / shaped.training.env_steps)
    assert sorted(ratios)[4] > 1.2
