"""Effects far below their usual size."""

from conftest import diagnosed


def test_a_wobble_of_4_percent_is_named_under_eq_6_2(tmp_path):
    # Once not found: friction that seemed to fluctuate hid what it promised.
    effect = "normal_force_wobble"
    case = diagnosed(tmp_path, effect, "normal_force_wobble_gauss", 71020, "--size", "small")
    finding = case.finding
    assert [found["name"] for found in finding["effects"]] == [effect], case.screen
    assert case.truth["effects"]["wobble_a"] < 0.045
    assert finding["gap"]["held_out"]["closed"] > 0.9
