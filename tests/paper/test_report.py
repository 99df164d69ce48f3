from stlspec.paper import report
from stlspec.paper.claims import CLAIMS
from stlspec.paper.experiments import SHAPED, STANDARD


def records(made):
    grids = made.as_json({"grid-5": {SHAPED: made.rows(100, 200), STANDARD: made.rows(400, 400)}})
    table_1 = dict(made.table_1, irl=made.irl)
    return {
        "table-1-grid-5": made.record("table-1-grid-5", table_1, 30.0),
        "grids": made.record("grids", grids, 90.0),
    }


GOLDEN = """\
- Budget: tiny: 2 seeds; on Mountain Car 1 with 50, 1 with 75, 1 with 100 bins, 2 episodes each.
- Time: 2 minutes in all, for 2 experiments.
- Machine: processors 2, python 3.11.0, stlspec 0.1.0.
- Processes that wanted a processor while measuring: 0.5 to 1.5.
"""


def test_the_report_says_how_much_was_measured_and_on_what(made):
    assert GOLDEN in report.write(records(made))


def test_every_claim_stands_in_the_report_with_verdict_figures_and_rule(made):
    text = report.write(records(made))
    assert f"{len(CLAIMS)} claims: 2 reproduced, {len(CLAIMS) - 2} not measured." in text
    assert "**The learned policy satisfies all requirements on single-goal grids.** Reproduced." in text
    assert "  - measured: grid-5: 2 of 2\n" in text
    for claim in CLAIMS:
        assert claim.says in text
        assert claim.rule in text


def test_sections_are_those_of_what_was_run(made):
    text = report.write(records(made))
    headings = [line for line in text.splitlines() if line.startswith("## ")]
    assert headings == [
        "## Claims of the paper", "## Table 1: time to infer the reward",
        "## How near the rewards come to the ground truth", "## Single-goal grids", "## Claims that are not examined",
        "## What is done differently",
    ]  # fmt: skip
    assert "- MCE-IRL on grid-5: converged after 10 gradient steps; budget 1000 gradient steps, horizon 16." in text


def test_what_could_not_be_measured_says_why(made):
    text = report.write({"table-1-lake-4": made.record("table-1-lake-4", made.table_1)})
    assert "- MCE-IRL on lake-4: not measured: there is no network." in text
    assert "faster than MCE-IRL on every row of Table 1.** Not measured." in text


def test_mountain_car_says_what_is_due_to_the_demonstrations(made):
    cars = made.as_json({"car-50": {SHAPED: made.rows(5, probability=1.0)}})
    text = report.write({"car-50": made.record("car-50", cars)})
    assert "## Mountain Car" in text
    assert "due to the demonstrations" in text


def test_figures_are_shown_under_their_headings(made):
    text = report.write(records(made), ["map-grid-5.png", "steps-grids.png", "truth-grid-5.png"])
    assert text.index("## Rewards and ground truth") < text.index("![truth-grid-5](figures/truth-grid-5.png)")
    assert text.index("## Exploration") < text.index("![steps-grids](figures/steps-grids.png)")


def test_a_report_of_nothing_says_so():
    text = report.write({})
    assert "Nothing was measured." in text
    assert f"{len(CLAIMS)} claims: {len(CLAIMS)} not measured." in text


def test_the_reward_of_mce_irl_is_shown_beside_ours_and_nothing(made):
    away = {"home": {"all": True}, "maps": 20, "hard": 12, "reached": 20, "all": 11}
    rows = made.as_json(
        {"lake-8, demonstrated": {"STL reward": made.rows(100, 100), "no information": made.rows(200, 200)}}
    )
    result = {
        "rows": rows,
        "asked": {"lake-8": {"STL reward": away}},
        "notes": {"lake-8": "converged", "grid-7": "absent"},
    }
    text = report.write({"rewards": made.record("rewards", result)})
    assert "## What the reward of MCE-IRL is good for" in text
    assert "- grid-7: absent." in text
    assert "What MCE-IRL does better" in text
    nothing = report.write(
        {"rewards": made.record("rewards", {"rows": {}, "asked": {}, "notes": {"lake-8": "absent"}})}
    )
    assert "- lake-8: absent." in nothing
    assert "does better" not in nothing
