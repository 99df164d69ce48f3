"""Verdicts are decided by rules: on made-up figures the verdict can be told by hand."""

from math import inf

import pytest

from stlspec.paper.claims import CLAIMS, Verdict, by_ratio, by_share, judge, worst
from stlspec.paper.experiments import EXPERIMENTS, LETTER, PLAIN, SHAPED, STANDARD, UNMASKED
from stlspec.paper.handmade import BY_DISTANCE
from stlspec.paper.spread import Spread

YES, PARTLY, NO, UNKNOWN = Verdict.REPRODUCED, Verdict.PARTLY, Verdict.NOT, Verdict.UNKNOWN
BY_NAME = {claim.name: claim for claim in CLAIMS}


def verdict(name, results):
    return judge(BY_NAME[name], results).verdict


@pytest.mark.parametrize(("share", "expected"), [(1, YES), (0.95, YES), (0.94, PARTLY), (0.5, PARTLY), (0.49, NO)])
def test_shares(share, expected):
    assert by_share(share) is expected


@pytest.mark.parametrize(
    ("quartiles", "expected"),
    [((1.01, 1.1, 3), YES), ((1, 2, 3), PARTLY), ((1.01, 1.09, 3), NO), ((0.5, 1, inf), NO), ((2, inf, inf), YES)],
)
def test_ratios(quartiles, expected):
    assert by_ratio(Spread(*quartiles)) is expected


@pytest.mark.parametrize(
    ("verdicts", "expected"),
    [([YES, YES], YES), ([YES, NO], PARTLY), ([PARTLY, NO], PARTLY), ([NO, NO], NO), ([PARTLY, PARTLY], PARTLY)],
)
def test_a_claim_about_several_groups_is_as_good_as_all_of_them(verdicts, expected):
    assert worst(verdicts) is expected


def test_what_was_not_run_is_not_measured_and_says_what_is_missing():
    for claim in CLAIMS:
        finding = judge(claim, {})
        assert finding.verdict is UNKNOWN
        assert all(name in finding.evidence for name in claim.needs)


def test_claims_need_experiments_that_there_are():
    assert {name for claim in CLAIMS for name in claim.needs} <= set(EXPERIMENTS)
    assert len(BY_NAME) == len(CLAIMS)


@pytest.mark.parametrize(
    ("steps", "expected"),
    [([5] * 20, YES), ([5] * 19 + [None], YES), ([5] * 18 + [None] * 2, PARTLY), ([None] * 20, NO)],
)
@pytest.mark.parametrize(
    ("claim", "experiment", "method"),
    [("grids", "grids", SHAPED), ("letter", "letter", LETTER), ("unseen", "transfer", SHAPED)],
)
def test_success_is_counted_over_seeds(made, claim, experiment, method, steps, expected):
    results = {experiment: made.as_json({"a map": {method: made.rows(*steps)}})}
    assert verdict(claim, results) is expected
    assert f"{20 - steps.count(None)} of 20" in judge(BY_NAME[claim], results).evidence


def test_one_size_that_fails_makes_it_partly(made):
    groups = {"grid-5": {SHAPED: made.rows(5, 5)}, "grid-7": {SHAPED: made.rows(None, None)}}
    assert verdict("grids", {"grids": made.as_json(groups)}) is PARTLY


def lake(made, standard, unmasked, distance=(2, 2, 2, 2), **fields):
    shaped = made.rows(1, 1, 1, 1)
    by = {SHAPED: shaped, STANDARD: made.rows(*standard, **fields), UNMASKED: made.rows(*unmasked)}
    dense = {SHAPED: shaped, BY_DISTANCE: made.rows(*distance)}
    return {
        "lakes": made.as_json({"lake-4": by}),
        "hand-crafted": made.as_json({"lake-4": dense, "grid-5": {SHAPED: made.rows(9), BY_DISTANCE: made.rows(1)}}),
    }


def test_exploration_is_judged_without_the_mask_whatever_the_mask_gains(made):
    assert verdict("exploration", lake(made, [10] * 4, [5, 5, 5, 5])) is YES
    assert verdict("exploration", lake(made, [10] * 4, [5, 5, 12, 12])) is PARTLY
    assert verdict("exploration", lake(made, [10] * 4, [None] * 4)) is PARTLY


def test_exploration_must_beat_a_reward_by_distance_too(made):
    slow = [12] * 4
    assert verdict("exploration", lake(made, [10] * 4, [9] * 4, distance=[1, 1, 1, 1])) is PARTLY
    assert verdict("exploration", lake(made, [10] * 4, slow, distance=[1, 1, 1, 1])) is NO
    evidence = judge(BY_NAME["exploration"], lake(made, [10] * 4, [5] * 4)).evidence
    assert "reward by distance, both with the mask, lake-4: 2 (2 to 2) times fewer" in evidence
    assert "grid-5" not in evidence


def test_safety_is_judged_by_violations(made):
    results = lake(made, [10] * 4, [10] * 4, violations=40)
    assert verdict("safety", results) is YES
    assert "10 (10 to 10) times fewer" in judge(BY_NAME["safety"], results).evidence
    assert verdict("safety", lake(made, [10] * 4, [10] * 4)) is NO


def test_two_goals_must_be_reached_in_the_shortest_time(made):
    late = made.rows(None, None, late=2)
    results = {"two-goals": made.as_json({"two-goal-5": {SHAPED: late, PLAIN: late}})}
    assert verdict("two-goals", results) is NO
    assert "safe and both goals two-goal-5: 2 of 2" in judge(BY_NAME["two-goals"], results).evidence


@pytest.mark.parametrize(
    ("imperfect", "none", "expected"), [([5, 5], [9, 9], YES), ([9, 9], [5, 5], PARTLY), ([None, None], [5, 5], NO)]
)
def test_imperfect_demonstrations_must_solve_and_help(made, imperfect, none, expected):
    by = {"imperfect only": made.rows(*imperfect), "none": made.rows(*none)}
    assert verdict("imperfect", {"ablation": made.as_json({"grid-5": by})}) is expected


@pytest.mark.parametrize(
    ("ours", "standard", "expected"),
    [([100, 200], [201, 300], YES), ([100, 100, 250], [201, 201, 300], PARTLY), ([100, 400], [90, 80], NO)],
)
def test_the_worst_of_ours_must_beat_the_best_of_standard(made, ours, standard, expected):
    def learned(steps):
        return [row for s in steps for row in made.rows(5, env_steps=s * 100)]

    cars = {
        f"car-{n}": made.as_json({f"car-{n}": {SHAPED: learned(ours), STANDARD: learned(standard)}})
        for n in (50, 75, 100)
    }
    assert verdict("car", cars) is expected
    assert f"worst of ours {max(ours)}" in judge(BY_NAME["car"], cars).evidence


def test_time_is_judged_on_every_row_and_missing_rows_count_against_it(made):
    faster, absent = dict(made.table_1, irl=made.irl), made.table_1
    slower = dict(made.table_1, irl=dict(made.irl, seconds=0.001))
    assert verdict("time", {"table-1-grid-5": faster, "table-1-grid-7": faster}) is YES
    assert verdict("time", {"table-1-grid-5": faster, "table-1-grid-7": absent}) is PARTLY
    assert verdict("time", {"table-1-grid-5": faster, "table-1-grid-7": slower}) is PARTLY
    assert verdict("time", {"table-1-grid-5": slower}) is NO
    assert verdict("time", {"table-1-grid-5": absent}) is UNKNOWN
    guessed = dict(made.table_1, irl=dict(made.irl, extrapolated=True))
    assert "times faster (extrapolated)" in judge(BY_NAME["time"], {"table-1-grid-5": guessed}).evidence
    assert "grid-5: 2 000 times faster" in judge(BY_NAME["time"], {"table-1-grid-5": faster}).evidence


def test_why_a_row_is_missing_stands_in_the_evidence(made):
    evidence = judge(BY_NAME["time"], {"table-1-grid-5": made.table_1}).evidence
    assert evidence == "MCE-IRL was not measured on grid-5: there is no network"


def test_the_ground_truth_is_judged_by_correlation(made):
    nearer = dict(made.table_1, irl=made.irl)
    farther = dict(made.table_1, irl=dict(made.irl, correlation=0.6))
    assert verdict("truth", {"table-1-grid-5": nearer, "table-1-grid-7": nearer}) is YES
    assert verdict("truth", {"table-1-grid-5": nearer, "table-1-grid-7": farther}) is PARTLY
    assert verdict("truth", {"table-1-grid-5": farther, "table-1-grid-7": farther}) is NO
    assert verdict("truth", {"table-1-grid-5": nearer, "table-1-grid-7": made.table_1}) is UNKNOWN


@pytest.mark.parametrize(
    ("correlations", "expected"),
    [
        ((0.1, 0.5, 0.71, 0.8), YES),
        ((0.1, 0.5, 0.8, 0.8), PARTLY),
        ((0.75, 0.5, 0.5, 0.8), NO),
        ((0.1, None, 0.5, 0.8), UNKNOWN),
    ],
)
def test_few_demonstrations_must_be_too_few(made, correlations, expected):
    rows = [dict(made.irl, correlation=value) for value in correlations]
    results = {"irl-demos": {"counts": [3, 10, 30, 70], "rows": rows, "irl": dict(made.irl, skipped="no network")}}
    assert verdict("few", results) is expected


def test_dimension_is_judged_by_time_for_each_sample():
    def results(large):
        times = {"5": {"seconds": 1e-3, "samples": 10}, "80": {"seconds": large, "samples": 100}}
        return {"demonstrations": {"worth": [], "times": times}}

    assert verdict("dimension", results(0.03)) is YES
    assert verdict("dimension", results(0.031)) is PARTLY
    assert verdict("dimension", results(0.11)) is NO


def test_signs_are_judged_over_all_demonstrations():
    def results(*bad):
        good = [{"label": "good", "reward": 1.0, "strict": False}]
        worth = good + [{"label": "bad", "reward": value, "strict": False} for value in bad]
        return {"demonstrations": {"worth": worth, "times": {}}}

    assert verdict("signs", results(-1.0, -0.1)) is YES
    assert verdict("signs", results(-1.0, 0.0)) is PARTLY
    assert verdict("signs", results(1.0)) is NO
