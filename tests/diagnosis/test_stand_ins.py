"""Two effects are hidden, and internal friction of the shaft imitates both."""

import pytest
from conftest import diagnosed


@pytest.mark.parametrize(
    ("first", "second", "seed"),
    [
        ("shaft_hardening", "stiction", 150000),
        pytest.param("bearing_friction", "sensor_delay", 150000, marks=pytest.mark.long),
        pytest.param("acceleration_hysteresis", "sensor_delay", 158010, marks=pytest.mark.long),
    ],
)
def test_what_stood_in_is_left_out_and_both_are_named(tmp_path, first, second, seed):
    case = diagnosed(tmp_path, first, f"{first}_and_{second}", seed, "--pairs")
    finding = case.finding
    assert {found["name"] for found in finding["effects"]} == {first, second}, case.screen
    assert finding["verdict"] == "named" and case.exit_code == 0
    assert finding["gap"]["held_out"]["closed"] > 0.98
