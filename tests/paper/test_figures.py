import pytest

from stlspec.paper.cases import case_of
from stlspec.paper.experiments import SHAPED, STANDARD, UNMASKED
from stlspec.paper.figures import draw_all, draw_curves, draw_dots, map_panels, scene_of, unseen_panels
from stlspec.paper.runs import groups

pytest.importorskip("matplotlib")


def is_picture(path):
    return path.read_bytes().startswith(b"\x89PNG")


def test_a_panel_for_each_demonstration_and_one_for_the_policy():
    case = case_of("grid-5")
    panels = map_panels(case)
    assert [label.split(":")[0] for label, _ in panels[:-1]] == ["good 1", "good 2", "bad 3"]
    label, scene = panels[-1]
    assert label == "inferred reward, learned policy"
    assert len(scene.path) == case.params["T_goal"] + 1
    assert max(scene.values) == 1.0
    bad = panels[2][1]
    assert [value < 0 for value in bad.values].count(True) == 1
    assert len(bad.path) == len(case.demos[2][1])


def test_the_policy_of_two_goals_numbers_its_stops():
    scene = map_panels(case_of("two-goal-5"))[-1][1]
    assert {divmod(stop, 5) for stop in scene.stops} == {(0, 4), (4, 4)}


def test_unseen_maps_are_drawn_with_their_own_holes():
    panels = unseen_panels("lake-4")
    assert len({scene.endings for _, scene in panels}) == 3


def test_marks_of_a_map_become_endings():
    scene = scene_of(case_of("lake-4"), [0.0] * 16, ())
    assert (scene.start, scene.n_columns, len(scene.endings)) == (0, 4, 16)
    assert len({scene.endings[k] for k in (5, 7, 11, 12)}) == 1
    assert scene.endings[15] != scene.endings[5] != scene.endings[0]


def test_curves_and_dots_are_pictures_also_where_nothing_succeeded(tmp_path, made):
    curve = (5.0,) * len(groups(100))
    by = {SHAPED: made.rows(5, 6, curve=curve), STANDARD: made.rows(None, None, curve=curve)}
    draw_curves([("one", by), ("two", by)], "title", tmp_path / "c.png")
    draw_dots({"one": by, "two": by}, lambda row: row.to_success, "steps", tmp_path / "d.png")
    assert is_picture(tmp_path / "c.png")
    assert is_picture(tmp_path / "d.png")


def test_only_what_was_measured_is_drawn(tmp_path, made):
    curve = (5.0,) * len(groups(100))
    by = {method: made.rows(5, 6, curve=curve) for method in (SHAPED, UNMASKED, STANDARD)}
    results = {
        "lakes": made.as_json({"lake-4": by}),
        "table-1-grid-5": dict(made.table_1, irl=made.irl),
        "car-50": made.as_json({"car-50": by}),
    }
    names = []
    drawn = draw_all(results, tmp_path, names.append)
    assert drawn == names == [
        "map-lake-4.png", "map-lake-8.png", "truth-grid-5.png", "steps-lakes.png", "exploration-lakes.png",
        "exploration-car.png", "car-reward.png",
    ]  # fmt: skip
    assert all(is_picture(tmp_path / name) for name in names)
    assert draw_all({}, tmp_path) == []
