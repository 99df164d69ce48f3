"""Tables from fixed figures, written out."""

from stlspec.paper import tables


def cells(text):
    return [[cell.strip() for cell in line.split("|")[1:-1]] for line in text.splitlines()]


def test_a_table_is_markdown_with_even_columns():
    assert tables.table(["", "n"], [["grid", "1"], ["b", "1000"]]) == (
        "|      |    n |\n| ---- | ---: |\n| grid |    1 |\n| b    | 1000 |"
    )


def test_times_are_written_in_their_unit():
    assert [tables.seconds(x) for x in (None, 0.00204, 0.9, 13.18)] == ["not measured", "2.04 ms", "900 ms", "13.2 s"]


def test_table_1_shows_the_paper_what_was_measured_and_their_ratio(made):
    results = {"table-1-grid-5": dict(made.table_1, irl=made.irl)}
    lines = cells(tables.table_1(results))
    assert lines[0] == [
        "", "method", "demos: paper", "here", "time: paper", "measured", "measured / paper", "times slower: paper",
        "measured",
    ]  # fmt: skip
    assert lines[2] == ["(5 x 5) grid", "STL reward", "3", "3", "2.62 s", "2 ms", "0.000763", "", ""]
    assert lines[3] == ["", "MCE-IRL", "70", "70", "3.77 s", "4 s", "1.06", "1.44", "2 000"]
    assert lines[11] == ["", "MCE-IRL", "10-20", "-", ">60 s", "not measured", "-", ">20.3", "-"]
    assert len(lines) == 12


def test_what_was_extrapolated_is_marked(made):
    results = {"table-1-grid-5": dict(made.table_1, irl=dict(made.irl, extrapolated=True))}
    assert "4 s *" in tables.table_1(results)


def test_learning_shows_quartiles_over_seeds(made):
    by = {"shaped": made.rows(100, 200), "standard": made.rows(400, None, violations=40)}
    lines = cells(tables.learning({"grid-5": by}, "standard"))
    assert lines[2] == ["grid-5", "shaped", "2", "2/2", "2/2", "100 (100 to 200)", "4 (4 to never)", "4 (4 to 4)"]
    assert lines[3] == ["grid-5", "standard", "2", "1/2", "2/2", "400 (400 to never)", "", "40 (40 to 40)"]


def test_a_comparison_with_what_was_not_run_is_left_out(made):
    assert cells(tables.learning({"grid-5": {"shaped": made.rows(1)}}, "standard"))[2][6] == ""


def test_mountain_car_shows_the_worst_and_the_best_average(made):
    rows = [row for steps, p in ((30000, 1.0), (50000, 0.9)) for row in made.rows(5, env_steps=steps, probability=p)]
    assert cells(tables.car({"car-50": {"shaped": rows}}))[2] == [
        "car-50", "shaped", "2", "300 (300 to 500)", "300", "500", "90.0%", "500 ms",
    ]  # fmt: skip


def test_the_letter_shows_who_circles(made):
    rows = made.rows(None, None, farming=True)
    assert cells(tables.letter({"grid-5": {"to the letter": rows}}))[2] == [
        "grid-5",
        "2",
        "0/2",
        "2/2",
        "2/2",
        "4 (4 to 4)",
    ]


def test_accuracy_lists_the_tasks_with_a_ground_truth(made):
    results = {"table-1-grid-5": dict(made.table_1, irl=made.irl), "table-1-lake-4": dict(made.table_1, truth=None)}
    lines = cells(tables.accuracy(results))
    assert lines[2:] == [["(5 x 5) grid", "+0.50", "16 of 25", "-0.25"]]


def test_more_and_more_demonstrations_are_listed(made):
    rows = [made.irl, dict(made.irl, correlation=None, seconds=None)]
    assert cells(tables.few({"counts": [3, 70], "rows": rows}))[2:] == [
        ["3", "-0.25", "4 s"], ["70", "not measured", "not measured"],
    ]  # fmt: skip


def test_what_rewards_ask_for_is_a_row_for_each():
    found = {"home": {"all": True}, "maps": 20, "hard": 12, "reached": 20, "all": 11}
    other = found | {"home": {"all": False}}
    lines = cells(tables.asked_for({"lake-8": {"STL reward": found, "MCE-IRL reward": other}}))
    assert lines[2] == ["FrozenLake-8", "STL reward", "all met", "20", "12", "20", "11"]
    assert lines[3][:3] == ["FrozenLake-8", "MCE-IRL reward", "not all met"]
