import json

from stlspec.paper.budgets import FULL, QUICK


def test_budgets_are_json_and_the_whole_is_no_smaller_than_the_look():
    quick, full = QUICK.to_json(), FULL.to_json()
    assert json.loads(json.dumps(full)) == full
    assert all(full[key] >= quick[key] for key in quick if key not in ("name", "car_seeds"))
    assert (full["seeds"], full["car_seeds"]) == (20, [[50, 5], [75, 2], [100, 2]])
