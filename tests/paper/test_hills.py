import pytest

from stlspec.paper.hills import drive


@pytest.mark.parametrize("seed", range(5))
def test_a_drive_ends_at_the_flag_before_the_step_limit_and_stays_in_bounds(seed):
    path = drive(seed)
    assert path[-1][0] >= 0.5
    assert all(-1.2 <= position < 0.5 and abs(velocity) <= 0.07 for position, velocity in path[:-1])
    assert 80 <= len(path) - 1 <= 160
    assert path == drive(seed)
