import pytest

from stlspec import score
from stlspec.paper.cases import BAD, KINDS, NAMES, PUBLISHED, TABLE_1, case_of, random_grid

LABELS = {"good": "good", "roundabout": "incomplete", "unfinished": "incomplete", "bad": "bad"}


@pytest.mark.parametrize("name", NAMES)
def test_every_demonstration_is_what_it_is_called(name):
    case = case_of(name)
    found = score(case.bundle(), case.demonstrations(), environment=case.environment())
    assert [d.label for d in found.demonstrations] == [LABELS[kind] for kind, _ in case.demos]


@pytest.mark.parametrize("name", TABLE_1)
def test_there_are_as_many_demonstrations_as_table_1_says(name):
    counts = [int(part) for part in PUBLISHED[name].demos.split("-")]
    assert counts[0] <= len(case_of(name).demos) <= counts[-1]


@pytest.mark.parametrize("name", ["grid-5", "lake-8", "two-goal-7", "car-50"])
def test_experts_meet_every_requirement_and_are_not_all_the_same(name):
    case = case_of(name)
    experts = case.experts(6)
    found = score(case.bundle(), experts, environment=case.environment())
    assert {d.label for d in found.demonstrations} == {"good"}
    assert len({tuple(map(tuple, e.recording.states)) for e in experts}) > 1


def test_seeds_draw_other_grids_and_the_same_one_again():
    kinds = KINDS["grid-7"]
    one, two = random_grid(7, 1, kinds, 3), random_grid(7, 1, kinds, 4)
    assert one == random_grid(7, 1, kinds, 3)
    assert one.map != two.map
    assert [kind for kind, _ in one.demos] == list(kinds)


def test_demonstrations_can_be_taken_by_kind():
    assert [d.name for d in case_of("grid-5").demonstrations(BAD)] == ["bad 3"]


def test_on_another_map_the_goal_is_due_in_the_shortest_time_there():
    rows = ("SFFF", "FHFH", "FFFF", "FHHG")
    case = case_of("lake-4").on_map(rows)
    assert case.map == rows
    assert dict(case.params) == {"T_goal": 6}
    assert case.demos == case_of("lake-4").demos


def test_the_package_holds_the_specs_of_all_cases():
    assert all(case_of(name).spec.is_file() for name in NAMES)


def test_no_other_name_is_a_case():
    with pytest.raises(KeyError):
        case_of("grid-6")
    with pytest.raises(KeyError):
        case_of("car-60")
