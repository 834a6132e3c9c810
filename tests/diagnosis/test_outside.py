"""What is hidden is in no catalogue: nothing is named, and the screen says so."""

import pytest
from conftest import diagnosed


@pytest.mark.parametrize(
    ("kind", "seed"),
    [
        # Once named unbalance with shaft hysteresis, both of no certain size.
        ("outside_encoder_eccentricity", 106009),
        # Once named Eq. 6-2, with peaks of no certain height.
        pytest.param("outside_friction_bump", 106002, marks=pytest.mark.long),
        # The same with one peak certain, and one that was an offset.
        pytest.param("outside_friction_bump", 136016, marks=pytest.mark.long),
        # The same with an offset of the load cell: together they bent like the bump.
        pytest.param("outside_friction_bump", 985002, marks=pytest.mark.long),
        # Once refused: the drive was too weak to turn, and u thought to be in mV.
        pytest.param("outside_torque_saturation", 136005, marks=pytest.mark.long),
    ],
)
def test_an_effect_that_no_catalogue_has_is_not_given_a_name(tmp_path, kind, seed):
    case = diagnosed(tmp_path, kind, kind, seed, "--outside")
    assert case.finding["verdict"] == "not_in_catalogue", case.screen
    assert case.finding["effects"] == [] and case.exit_code == 1
