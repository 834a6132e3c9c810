"""A law of many numbers whose fit gets stuck on the way to them."""

import pytest
from conftest import diagnosed


@pytest.mark.long
def test_eq_6_2_is_found_from_a_start_that_did_not_promise_most(tmp_path):
    # Once flagged: the two starts that were followed led to numbers that Stribeck's law outdid.
    effect = "acceleration_hysteresis"
    case = diagnosed(tmp_path, effect, "acceleration_hysteresis_c", 181021)
    finding = case.finding
    assert [found["name"] for found in finding["effects"]] == [effect], case.screen
    assert finding["verdict"] == "named" and case.exit_code == 0
    assert finding["gap"]["held_out"]["closed"] > 0.9
    assert finding["ranking"][0]["name"] == effect


@pytest.mark.long
def test_an_effect_of_no_size_is_not_named_beside_eq_6_2(tmp_path):
    # Once named with a resistance drift, then with a backlash, either zero within its interval: its fit started five windows better.
    effect = "acceleration_hysteresis"
    case = diagnosed(tmp_path, effect, effect, 570022)
    finding = case.finding
    assert [found["name"] for found in finding["effects"]] == [effect], case.screen
    assert finding["verdict"] == "named" and case.exit_code == 0
