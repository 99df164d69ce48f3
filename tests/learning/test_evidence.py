"""What demonstrations contribute: a reward, and pairs to mask where they were made."""

from dataclasses import replace

import pytest

from stlspec.demos import make_demonstration
from stlspec.errors import DataError
from stlspec.learning.evidence import gather, notes, violating_pairs
from stlspec.learning.shaping import GOAL, RUNS, VIOLATION
from stlspec.learning.task import SETTLED, Task, make_world, segment
from stlspec.learning.training import guide_of
from stlspec.rewards import infer_reward

# 0 -> 1 by both actions, 1 -> 2 (violates) by action 1
TASK = Task("g", 4, 2, 0, ((1, 1), (0, 2), (3, 3), (3, 3)), (RUNS, RUNS, VIOLATION, GOAL), ((0.0,),) * 4)


@pytest.mark.parametrize(
    ("states", "expected"),
    [((0, 1, 2, 3), {(1, 1)}), ((0, 1, 0), set()), ((0, 2), set()), ((2, 3), set())],
)
def test_the_pairs_by_which_a_violation_was_entered_are_masked(states, expected):
    assert violating_pairs(TASK, states) == expected


def gathered(small, demonstrations=None, world=None, **given):
    bundle, home, demos = small
    world = world or home
    demos = demos if demonstrations is None else demonstrations
    fields = {"reward": None, "demo_environment": None, **given}
    found = make_world(bundle, world, 100)
    return gather(bundle, segment(found, found.product.start, SETTLED), world, demos, **fields)


def test_bad_demonstrations_fill_the_mask_on_their_own_map(small):
    """By hand, pub-g5-0: the bad one enters (4, 1) from (4, 0) and (4, 3) from (4, 2), both to the right."""
    evidence = gathered(small)
    assert evidence.violating == ((20, 2), (22, 2))
    assert (evidence.bad, evidence.bad_elsewhere) == (1, 0)
    assert evidence.reward == infer_reward(small[0], small[2], small[1])


def test_on_another_map_they_fill_nothing(small, kit):
    """The same map without the obstacle at (4, 1): the table is the same, but its meaning is not."""
    other = kit.grid_world(("#...G", ".....", "#....", ".....", "S..#."))
    evidence = gathered(small, world=other, demo_environment=small[1])
    assert evidence.violating == ()
    assert evidence.bad_elsewhere == 1


def test_a_reward_is_at_home_on_the_very_map_that_it_was_made_on_only(small, kit):
    other = kit.grid_world(("#...G", ".....", "#....", ".....", "S..#."))
    here, elsewhere = gathered(small), gathered(small, world=other, demo_environment=small[1])
    assert (here.at_home, elsewhere.at_home) == (True, False)
    assert gathered(small, [], reward=here.reward).at_home
    assert not gathered(small, [], other, reward=here.reward).at_home
    homeless = replace(here.reward, environment={"id": "unknown/Lake-v9", "args": {}, "map": None})
    assert not gathered(small, [], reward=homeless).at_home


def test_a_given_reward_is_taken_and_other_specs_are_told(small, kit):
    reward = infer_reward(small[0], small[2][:1], small[1])
    assert gathered(small, reward=reward).reward == reward
    assert gathered(small, reward=reward).warnings == ()
    other = replace(reward, meaning_sha256="0" * 64)
    assert [w.code for w in gathered(small, reward=other).warnings] == ["D865"]


def test_a_reward_of_0_is_a_warning(small):
    (warning,) = gathered(small, demonstrations=[]).warnings
    assert warning.code == "D864"
    assert "no demonstrations" in warning.message


def test_the_report_says_what_bad_demonstrations_did(small):
    evidence = gathered(small)
    assert "2 steps forbidden from the start" in notes(evidence, "shaped", True)[0]
    assert "forbidden from the start; training does not use their values" in notes(evidence, "plain", True)[0]
    assert "another map" in notes(replace(evidence, bad_elsewhere=evidence.bad), "shaped", True)[0]
    assert "training does not use what went wrong" in notes(evidence, "shaped", False)[0]
    assert "only the reward map" in notes(evidence, "paper", False)[0]
    assert notes(replace(evidence, bad=0), "shaped", True) == ()
    assert "it shapes little" in notes(replace(evidence, bad=0, at_home=False), "shaped", True)[0]
    assert notes(replace(evidence, bad=0, at_home=False), "plain", True) == ()


def test_values_of_bad_demonstrations_stand_in_the_map_and_training_does_not_use_them(small):
    """What the report says of bad demonstrations, held to what the reward map and the potential are."""
    world = small[1]
    evidence = gathered(small)
    assert min(evidence.reward.table(world)) < 0
    without = gathered(
        small, demonstrations=[d for d, r in zip(small[2], evidence.ranked, strict=True) if r.label != "bad"]
    )
    goal = [value == max(evidence.reward.table(world)) for value in evidence.reward.table(world)]
    shaped, same = (guide_of(e, world, "shaped")(world.start, goal) for e in (evidence, without))
    assert min(shaped) >= 0.0
    assert [value > 0 for value in shaped] == [value > 0 for value in same]


def test_a_demonstration_of_an_environment_that_cannot_be_made_is_not_taken_for_one_of_this_map(small):
    states = [[4, 0], [4, 1], [4, 2]]
    lost = make_demonstration("lost", {"d_obs": [1, 0, 1], "d_goal": [8, 7, 6]}, states=states, env={"id": "No-v9"})
    for reward in (None, infer_reward(small[0], small[2], small[1])):
        with pytest.raises(DataError) as caught:
            gathered(small, demonstrations=[lost], reward=reward)
        (found,) = caught.value.diagnostics
        assert found.code == "D875"
        assert "'No-v9' cannot be made here" in found.message


def test_one_bad_demonstration_and_one_step_are_told_in_the_singular(small):
    evidence = replace(gathered(small), violating=((20, 2),), bad=1)
    assert notes(evidence, "shaped", True)[0].startswith("1 bad demonstration: 1 step forbidden")
