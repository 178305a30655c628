"""The account itself; that those of all runs close, test_trajectory.py holds."""

from dataclasses import replace

import pytest

from railjoule.core import Energy

ACCOUNT = Energy(
    traction_j=36e6,
    recuperated_j=7.2e6,
    auxiliary_j=3.6e6,
    running_resistance_j=10e6,
    curve_resistance_j=2e6,
    losses_j={"drive": 5e6, "friction_brakes": 1.8e6},
    kinetic_j=4e6,
    potential_j=6e6,
)
"""28.8 MJ come in, and go into resistance, losses, speed and height; auxiliaries stand beside that."""


def test_net_energy_counts_auxiliaries():
    assert ACCOUNT.net_j == 36e6 - 7.2e6 + 3.6e6
    assert ACCOUNT.net_kwh == pytest.approx(9)


def test_a_closed_account_has_no_imbalance():
    assert ACCOUNT.imbalance == 0


@pytest.mark.parametrize("part", ["running_resistance_j", "curve_resistance_j", "kinetic_j", "potential_j"])
def test_a_joule_too_much_shows_as_a_share_of_what_moved(part):
    wrong = replace(ACCOUNT, **{part: getattr(ACCOUNT, part) + 4.32e4})
    assert wrong.imbalance == pytest.approx(4.32e4 / 43.2e6)


def test_a_missing_loss_shows_too():
    assert replace(ACCOUNT, losses_j={"drive": 5e6}).imbalance == pytest.approx(-1.8 / 43.2)


def test_parts_in_kwh():
    assert ACCOUNT.in_kwh() == {
        "traction": pytest.approx(10),
        "recuperated": pytest.approx(2),
        "auxiliary": pytest.approx(1),
        "running_resistance": pytest.approx(10 / 3.6),
        "curve_resistance": pytest.approx(2 / 3.6),
        "kinetic": pytest.approx(4 / 3.6),
        "potential": pytest.approx(6 / 3.6),
        "losses": {"drive": pytest.approx(5 / 3.6), "friction_brakes": pytest.approx(0.5)},
    }


def test_losses_are_a_frozen_copy():
    losses = {"drive": 1.0}
    energy = replace(ACCOUNT, losses_j=losses)
    losses["drive"] = 2.0
    assert energy.losses_j["drive"] == 1
    with pytest.raises(TypeError):
        energy.losses_j["drive"] = 2.0
