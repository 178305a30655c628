"""Random steps within random boxes lie above the planes and within the lines of their mode."""

import math

import numpy as np
import pytest
from proven_trains import CASES, name_of, scenario_of

from railjoule.core.chain_proof.boxes import (
    BLEND,
    BRAKE,
    COLUMNS,
    DRIVE,
    ENERGY,
    LOWER,
    OFF,
    TIME,
    UPPER,
    Box,
    cell_motion,
    fill_box,
)
from railjoule.core.chain_proof.proof import drive_table
from railjoule.core.drive.kernels import has_idle_losses, has_standstill_brake, negligible_effort
from railjoule.core.motion import build_meshed_line
from railjoule.core.motion.cell_step import COAST, exit_speed2
from railjoule.core.motion.passes import max_speeds
from railjoule.core.physics.effort_limit import max_effort
from railjoule.core.physics.energy_balance import cell_balance
from railjoule.core.physics.mesh_data import cell_at, train_data

STEPS = 1500
SLOWEST2 = 0.01


def mode_of(data, account):
    """Return the mode in which the account of a cell counts as driven."""
    if account.tractive_effort_n > 0.0:
        off = negligible_effort(data.drive_kind, data.drive_parameters)
        return OFF if account.tractive_effort_n <= off else DRIVE
    if account.power_w == 0.0:
        return OFF
    strongest = max_effort(data.braking, account.mean_speed_ms)
    whole = account.electric_braking_n + account.friction_braking_n
    return BRAKE if whole <= strongest else BLEND


def random_box(rng, w, y, lowest, greatest):
    """Return a box of any width around a step, within the speeds of its nodes."""
    ends = []
    for square, low, high in ((w, lowest[0], greatest[0]), (y, lowest[1], greatest[1])):
        v, width = math.sqrt(square), 10.0 ** rng.uniform(-3, 0.7)
        share = rng.random()
        a, b = (v - share * width) ** 2 if v > share * width else 0.0, (v + (1 - share) * width) ** 2
        ends += [min(max(a, low), square), max(min(b, high), square)]
    return Box(*ends)


@pytest.mark.parametrize("case", CASES, ids=name_of)
def test_steps_lie_above_the_planes_of_their_boxes(case):
    data = build_meshed_line(scenario_of(case)).data
    greatest, _, _ = max_speeds(data)
    fixed = data.fixed_speed2
    lowest = np.where(fixed >= 0, np.maximum(fixed, 0), np.minimum(SLOWEST2, greatest))
    table = drive_table(data, greatest, lowest)
    drive = data.drive_kind, data.drive_parameters
    friction = data.friction_effort_n, negligible_effort(*drive), bool(has_standstill_brake(*drive))
    rng, seen, close = np.random.default_rng(5), dict.fromkeys(range(4), 0), []
    for _ in range(STEPS):
        i = int(rng.integers(len(greatest) - 1))
        steps, row = cell_motion(data, i), np.empty(COLUMNS)
        w = rng.uniform(lowest[i], greatest[i])
        force = rng.uniform(-1.3, 1.0) * data.traction.constant_n
        y = (force + steps.k0 * w - steps.least_n - steps.linear * math.sqrt(w)) / steps.k1
        if rng.random() < 0.3:
            # coasting, but for rounding
            y = exit_speed2(cell_at(data, i), train_data(data), data.traction, data.braking, w, COAST)
        else:
            y = min(max(y, lowest[i + 1], w - steps.fall), greatest[i + 1], w + steps.rise)
        if y <= 0.0 and w <= 0.0:
            continue
        account = cell_balance(cell_at(data, i), train_data(data), data.traction, data.braking, drive[1], w, y)
        if (
            account.excess_n > 0.0
            or not lowest[i + 1] <= y <= greatest[i + 1]
            or abs(y - w) > max(steps.rise, steps.fall)
        ):
            continue
        mode = mode_of(data, account)
        box = random_box(rng, w, y, lowest[i : i + 2], greatest[i : i + 2])
        prices = (
            rng.uniform(0, 2e5),
            -rng.uniform(0, 1.5) * data.half_inertia_kg,
            -rng.uniform(0, 1.5) * data.half_inertia_kg,
        )
        assert fill_box(table, steps, data.traction, data.braking, friction, mode, box, prices, row)
        energy, time = account.supply_power_w * account.duration_s, account.duration_s
        size = data.traction.constant_n * steps.length_m
        below = row[ENERGY] + row[ENERGY + 1] * w + row[ENERGY + 2] * y
        assert below <= energy + 1e-9 * size
        assert row[TIME] + row[TIME + 1] * w + row[TIME + 2] * y <= time * (1 + 1e-12)
        assert row[LOWER] + row[LOWER + 1] * w <= y * (1 + 1e-9) + 1e-9
        assert y <= (row[UPPER] + row[UPPER + 1] * w) * (1 + 1e-9) + 1e-9
        seen[mode] += 1
        widest = max(math.sqrt(box[1]) - math.sqrt(box[0]), math.sqrt(box[3]) - math.sqrt(box[2]))
        if mode == DRIVE and widest < 0.02 and account.mean_speed_ms > 3.0:
            close.append((energy - below) / energy)
    assert seen[DRIVE] > 100
    # a smooth drive that coasts but for rounding drives or brakes a little, and takes as little
    assert seen[OFF] > (50 if has_idle_losses(data.drive_kind) else 10)
    assert seen[BRAKE] > 50
    if data.friction_effort_n > 0.0:
        assert seen[BLEND] > 10
    # narrow boxes hold the energy to some parts of a thousand
    assert np.median(close) < 5e-3
