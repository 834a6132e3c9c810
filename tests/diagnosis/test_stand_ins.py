"""Another effect than those that are hidden does most at first, and stands in for them."""

from conftest import diagnosed


def test_stiction_beside_a_hardening_shaft_although_internal_friction_of_the_shaft_gains_more(tmp_path):
    case = diagnosed(tmp_path, "shaft_hardening", "shaft_hardening_and_stiction", 150000, "--pairs")
    finding = case.finding
    assert "once more without shaft_hysteresis" in case.screen
    assert {found["name"] for found in finding["effects"]} == {"shaft_hardening", "stiction"}, case.screen
    assert finding["verdict"] == "named" and case.exit_code == 0
    assert finding["gap"]["held_out"]["closed"] > 0.98
    assert finding["ranking"][0]["name"] == "shaft_hysteresis"  # the ranking keeps what did most
