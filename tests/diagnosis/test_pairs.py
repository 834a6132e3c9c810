"""The contact follows Eq. 6-2 and something else is missing too: both are named."""

import pytest
from conftest import diagnosed


@pytest.mark.parametrize(
    ("second", "seed"),
    [
        ("backlash", 98000),  # once flagged for what the law alone had left
        # Once flagged, since the law's numbers had bent to make up for it.
        pytest.param("normal_force_wobble", 108007, marks=pytest.mark.long),
        # Once flagged, since friction seemed to fluctuate as much as wear changed it.
        pytest.param("friction_wear", 118002, marks=pytest.mark.long),
        # Once flagged, since bearing friction left less by a few windows, and much in all others.
        pytest.param("quadratic_drag", 118008, marks=pytest.mark.long),
        # Once flagged, since it showed neither beside the law nor without it.
        pytest.param("load_cell_bias", 138004, marks=pytest.mark.long),
    ],
)
def test_the_law_and_another_effect(tmp_path, second, seed):
    law = "acceleration_hysteresis"
    case = diagnosed(tmp_path, law, f"{law}_and_{second}", seed, "--pairs")
    finding = case.finding
    assert {found["name"] for found in finding["effects"]} == {law, second}, case.screen
    assert finding["verdict"] == "named" and case.exit_code == 0
    assert finding["gap"]["held_out"]["closed"] > 0.98
