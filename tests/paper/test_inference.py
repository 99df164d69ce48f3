from dataclasses import replace
from math import nan

import pytest

from stlspec.paper.cases import case_of, on_rows
from stlspec.paper.inference import correlation, ground_truth, infer, time_cold, time_inference, worth
from stlspec.rewards import infer_reward


def test_a_reward_is_inferred_by_the_name_of_its_case():
    case = case_of("grid-5")
    assert infer("grid-5").values == infer_reward(case.bundle(), case.demonstrations(), case.environment()).values


def test_times_come_with_the_sizes_that_they_depend_on():
    found = time_inference(case_of("grid-5"), 3)
    assert (found["demonstrations"], found["samples"], found["states"]) == (3, 27, 25)
    assert found["valued"] == len(infer("grid-5").values)
    assert 0 < found["seconds"] < 5


def test_bins_count_as_states():
    assert time_inference(case_of("car-50"), 1)["states"] == 2500


def test_a_fresh_process_takes_longer_than_the_inference():
    case = case_of("lake-4")
    assert time_cold(case, 1) > time_inference(case, 3)["seconds"]


def test_a_case_that_does_not_exist_fails_in_the_fresh_process(capfd):
    with pytest.raises(Exception, match="exit status 1"):
        time_cold(replace(case_of("lake-4"), name="lake-5"), 1)


def test_what_demonstrations_are_worth_follows_their_labels():
    rows = worth(on_rows("grid-3", "a grid", "stlspec/GridWorld-v0", ("..G", ".#.", "S.."), ("good", "bad"), 0))
    good, bad = rows
    assert (good["kind"], good["label"], good["hard"]) == ("good", "good", True)
    assert (bad["label"], bad["hard"], bad["strict"], bad["rank"]) == ("bad", False, False, 1)
    assert good["strict"] is False  # next to the obstacle the robustness is 0
    assert good["reward"] > 0 > bad["reward"]


def test_the_ground_truth_is_that_of_the_paper():
    assert ground_truth((".G", "#S")) == [1.0, 2.0, 0.0, 1.0]
    assert ground_truth(("SH1",)) == [1.0, 0.0, 2.0]


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ([0, 1, 2], 1.0),
        ([5, 3, 1], -1.0),
        ([10, 20, 30], 1.0),
        ([1, 1, 1], None),
        ([1, nan, 2], None),
        ([1, 0, 1], 0.0),
        ([-1e299, 0.0, 1e299], 1.0),
        ([0.0, 1e-320, 2e-320], 1.0),
    ],
)
def test_correlation_counts_neither_scale_nor_offset(values, expected):
    found = correlation(values, [1, 2, 3])
    assert found is None if expected is None else found == pytest.approx(expected)
