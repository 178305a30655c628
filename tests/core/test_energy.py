"""The account itself; that those of all runs close, test_trajectory.py holds."""

from dataclasses import replace

import numpy as np
import pytest

from railjoule.core import Energy
from railjoule.core.energy import energy_decimals, share_above

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
    assert replace(ACCOUNT, **{part: getattr(ACCOUNT, part) + 4.32e4}).imbalance == pytest.approx(4.32e4 / 43.2e6)


def test_a_missing_loss_shows_too():
    assert replace(ACCOUNT, losses_j={"drive": 5e6}).imbalance == pytest.approx(-1.8 / 43.2)


def test_losses_are_a_frozen_copy():
    losses = {"drive": 1.0}
    energy = replace(ACCOUNT, losses_j=losses)
    losses["drive"] = 2.0
    assert energy.losses_j["drive"] == 1
    with pytest.raises(TypeError):
        energy.losses_j["drive"] = 2.0


@pytest.mark.parametrize(("energy", "reference", "share"), [(12.0, 10.0, 0.2), (9.0, 10.0, -0.1), (101.0, 1.02, 98.02)])
def test_a_share_is_relative_to_the_reference(energy, reference, share):
    assert share_above(energy, reference) == pytest.approx(share, rel=1e-3)


@pytest.mark.parametrize(
    ("energy", "reference"), [(27.5, -0.628), (1.0, 0.0), (101.0, 1.0), (-1.0, -2.0), (np.nan, 1.0), (1.0, -np.inf)]
)
def test_a_reference_that_is_negative_or_next_to_nothing_is_no_measure(energy, reference):
    assert np.isnan(share_above(energy, reference))


def test_shares_of_tables_go_cell_by_cell():
    share = share_above(np.array([[11.0, np.nan], [3.0, 4.0]]), np.array([10.0, -1.0])[:, None])
    assert share[0, 0] == pytest.approx(0.1)
    assert np.isnan(share).tolist() == [[False, True], [True, True]]


@pytest.mark.parametrize(("kwh", "decimals"), [(4.9994, 3), (5.0, 2), (-0.3, 3), (-7.0, 2)])
def test_energies_below_five_have_three_decimals(kwh, decimals):
    assert energy_decimals(kwh) == decimals
