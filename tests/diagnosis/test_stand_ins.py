"""Internal friction of the shaft does most at first, and stands in for the effects that are hidden."""

import pytest
from conftest import diagnosed


@pytest.mark.parametrize(
    ("first", "second", "seed", "anew"),
    [
        ("shaft_hardening", "stiction", 150000, True),  # once flagged
        ("bearing_friction", "sensor_delay", 150000, True),  # once named with a relaxation as slow as its range allows
        ("acceleration_hysteresis", "sensor_delay", 158010, False),  # once flagged although nothing was left
    ],
)
def test_what_stood_in_is_left_out_and_both_are_named(tmp_path, first, second, seed, anew):
    case = diagnosed(tmp_path, first, f"{first}_and_{second}", seed, "--pairs")
    finding = case.finding
    # Where both are found beside the stand-in, it is dropped without another search.
    assert ("once more without shaft_hysteresis" in case.screen) == anew
    assert {found["name"] for found in finding["effects"]} == {first, second}, case.screen
    assert finding["verdict"] == "named" and case.exit_code == 0
    assert finding["gap"]["held_out"]["closed"] > 0.98
    assert finding["ranking"][0]["name"] == "shaft_hysteresis"  # the ranking keeps what did most
