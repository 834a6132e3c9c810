"""Effects far below their usual size, or seen in few places only."""

import pytest
from conftest import diagnosed


def test_a_wobble_of_4_percent_is_named_under_eq_6_2(tmp_path):
    # Once not found: friction that seemed to fluctuate hid what it promised.
    effect = "normal_force_wobble"
    case = diagnosed(tmp_path, effect, "normal_force_wobble_gauss", 71020, "--size", "small")
    finding = case.finding
    assert [found["name"] for found in finding["effects"]] == [effect], case.screen
    assert case.truth["effects"]["wobble_a"] < 0.045
    assert finding["gap"]["held_out"]["closed"] > 0.9


@pytest.mark.long
def test_a_breakaway_that_shows_only_where_two_runs_begin_is_named(tmp_path):
    # Once left to the parameters: resampled windows say nothing sure where so few of them tell.
    case = diagnosed(tmp_path, "stiction", "stiction", 83013)
    finding = case.finding
    assert [found["name"] for found in finding["effects"]] == ["stiction"], case.screen
    low, high = finding["effects"][0]["parameters"]["mu_s"]["interval95"]
    # The maker draws mu_s = 0.1938 for this seed.
    assert low < 0.1938 < high and high - low < 0.05
    assert finding["gap"]["held_out"]["closed"] > 0.98
