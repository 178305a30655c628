"""The table of a drive lies below its account everywhere between its points, and not far below."""

import numpy as np
import pytest
from every_drive import train
from proven_trains import CASES, IDLING, SMOOTH, name_of, scenario_of

from railjoule.core.chain_proof.table import EFFORTS, SPEEDS, premise, row_at, tabulate
from railjoule.core.drive.kernels import driving_power, generated_power
from railjoule.core.drive.kinds import CONSTANT_EFFICIENCY, COPPER_LOSS, INDUCTION, LOSS_MAP, LOSS_POLYNOMIAL
from railjoule.core.drive.line_power import line_power
from railjoule.core.motion import build_meshed_line
from railjoule.core.physics.braking import electric_effort

SLOWEST, FASTEST = 0.05, 25.0
POINTS = 4000


def interpolated(table, side, effort, speed):
    """Return the bilinear interpolant of the table [J/m], element by element."""
    row, column = np.array([row_at(table, v) for v in speed]), effort / table.top_n[side] * EFFORTS
    j, k = np.minimum(row.astype(int), SPEEDS - 1), np.minimum(column.astype(int), EFFORTS - 1)
    low = table.low[side]
    # rows are not equally far apart: the fraction by speed, not by row
    rows = table.slowest_ms + (table.fastest_ms - table.slowest_ms) * (np.array([j, j + 1]) / SPEEDS) ** 2
    u, t = (speed - rows[0]) / (rows[1] - rows[0]), column - k
    before, after = (1 - t) * low[j, k] + t * low[j, k + 1], (1 - t) * low[j + 1, k] + t * low[j + 1, k + 1]
    return (1 - u) * before + u * after


def points(limit, seed):
    """Return random efforts within a limit and speeds, denser near rest and at the limit's ends."""
    rng = np.random.default_rng(seed)
    speed = SLOWEST + (FASTEST - SLOWEST) * rng.random(POINTS) ** 2
    return np.clip(rng.uniform(-0.05, 1.05, POINTS), 1e-6, 1.0) * limit.effort_n(speed), speed


@pytest.mark.parametrize("case", CASES, ids=name_of)
def test_no_account_lies_below_the_table(case):
    data = build_meshed_line(scenario_of(case)).data
    table = tabulate(data, SLOWEST, FASTEST)
    effort, speed = points(data.traction, 1)
    kind, drive = data.drive_kind, data.drive_parameters
    taken = np.array([driving_power(kind, drive, x, v)[0] for x, v in zip(effort, speed, strict=True)]) / speed
    over = taken - interpolated(table, 0, effort, speed)
    assert over.min() >= -1e-9 * taken.max()
    braking, speed = points(data.braking, 2)
    strongest, friction = data.braking.effort_n(speed), data.friction_effort_n
    per_metre = np.empty(POINTS)
    for i in range(POINTS):
        electric = electric_effort(kind, drive, braking[i], speed[i], strongest[i], friction)
        power = -generated_power(kind, drive, electric, speed[i])[0]
        # no power is a mode of its own
        per_metre[i] = line_power(power, data.recuperation_factor) / speed[i] if power != 0.0 else np.inf
    over = per_metre - interpolated(table, 1, braking, speed)
    assert over.min() >= -1e-9 * taken.max()


@pytest.mark.parametrize("drive", [*IDLING, *SMOOTH])
def test_the_table_is_close_to_the_drive(drive):
    data = build_meshed_line(train(drive)).data
    table = tabulate(data, SLOWEST, FASTEST)
    effort, speed = points(data.traction, 3)
    effort, speed = effort[speed > 2.0], speed[speed > 2.0]
    power = [driving_power(data.drive_kind, data.drive_parameters, x, v)[0] for x, v in zip(effort, speed, strict=True)]
    taken = np.array(power) / speed
    # the sag of 128 x 256 rectangles is some 1e-4 of the energy: with one curvature of it left out the first test fails
    assert np.median(1.0 - interpolated(table, 0, effort, speed) / taken) < 1e-3


def test_only_machines_have_a_premise():
    for kind in (CONSTANT_EFFICIENCY, COPPER_LOSS, LOSS_POLYNOMIAL, LOSS_MAP):
        assert premise(kind) == ""
    assert "1.5 times" in premise(INDUCTION)
