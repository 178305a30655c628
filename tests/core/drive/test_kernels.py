"""Loss models in compiled code: values from their formulas, derivatives from complex steps and differences."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from railjoule.core.drive import Drive, kernels
from railjoule.core.drive import kinds as kinds_of_drives
from railjoule.core.drive.kinds import CAPABILITIES, CONSTANT_EFFICIENCY, COPPER_LOSS

KINDS = {
    CONSTANT_EFFICIENCY: np.array([0.8, 0.7]),
    COPPER_LOSS: np.array([2.5e-5]),
}
efforts = st.floats(0, 2e5)
speeds = st.floats(0.1, 60)
kinds = st.sampled_from(sorted(KINDS))
STEP = 1e-30


def by_hand(kind, braking, effort, speed):
    """Line power or generated power: efficiency times wheel power, or wheel power and R i^2."""
    if kind == CONSTANT_EFFICIENCY:
        return effort * speed * KINDS[kind][1] if braking else effort * speed / KINDS[kind][0]
    loss = KINDS[kind][0] * effort * effort
    return effort * speed - loss if braking else effort * speed + loss


@given(kind=kinds, braking=st.booleans(), effort=efforts, speed=speeds)
def test_powers_and_derivatives(kind, braking, effort, speed):
    kernel = kernels.generated_power if braking else kernels.driving_power
    p, p_f, p_v, p_ff, p_fv, p_vv = kernel(kind, KINDS[kind], effort, speed)
    assert p == pytest.approx(by_hand(kind, braking, effort, speed), rel=1e-14, abs=1e-9)
    # complex steps lose no digits
    assert p_f == pytest.approx(by_hand(kind, braking, effort + STEP * 1j, speed).imag / STEP, rel=1e-12, abs=1e-12)
    assert p_v == pytest.approx(by_hand(kind, braking, effort, speed + STEP * 1j).imag / STEP, rel=1e-12, abs=1e-9)
    for second, first, df, dv in ((p_ff, 1, 1.0, 0.0), (p_fv, 1, 0.0, 1e-3), (p_vv, 2, 0.0, 1e-3)):
        after, before = (kernel(kind, KINDS[kind], effort + s * df, speed + s * dv)[first] for s in (1, -1))
        assert second == pytest.approx((after - before) / (2 * (df + dv)), rel=1e-6, abs=1e-6)


@given(kind=kinds, effort=efforts, speed=speeds)
def test_bounds_of_work_hold(kind, effort, speed):
    drawn, returned = kernels.work_bounds(kind, KINDS[kind])
    work = effort * speed
    assert kernels.driving_power(kind, KINDS[kind], effort, speed)[0] >= drawn * work * (1 - 1e-12)
    assert kernels.generated_power(kind, KINDS[kind], effort, speed)[0] <= returned * work * (1 + 1e-12)


@given(kind=kinds, effort=efforts, speed=speeds)
def test_only_a_marked_drive_draws_power_to_brake(kind, effort, speed):
    draws = kernels.generated_power(kind, KINDS[kind], effort, speed)[0] < 0
    assert not draws or kernels.may_draw_while_braking(kind)


def test_copper_loss_draws_power_near_standstill():
    """R i^2 exceeds F v below v = coefficient F."""
    effort = 1e5
    border = KINDS[COPPER_LOSS][0] * effort
    slower, faster = (
        kernels.generated_power(COPPER_LOSS, KINDS[COPPER_LOSS], effort, border * share)[0] for share in (0.99, 1.01)
    )
    assert slower < 0 < faster
    assert math.isclose(slower, -faster, rel_tol=1e-9)


def test_each_kind_has_its_row_of_capabilities():
    numbers = {name: value for name, value in vars(kinds_of_drives).items() if isinstance(value, int)}
    assert sorted(numbers.values()) == list(range(len(CAPABILITIES)))
    assert [kernels.has_idle_losses(kind) for kind in range(5)] == [False, False, True, True, True]
    assert [kernels.may_draw_while_braking(kind) for kind in range(5)] == [False, True, True, True, True]
    assert [row.geared for row in CAPABILITIES[:5]] == [False, False, False, True, True]


@pytest.mark.parametrize("unknown", [-1, len(CAPABILITIES), 99])
def test_an_unknown_kind_is_no_drive(unknown):
    """Review A6: the next number was a geared map drive that idles, whatever its file said."""
    with pytest.raises(ValueError, match=f"drive kind {unknown} has no row"):
        Drive(unknown, np.zeros(2), 0.0, "none", None)


@pytest.mark.parametrize("asked", [kernels.has_idle_losses, kernels.may_draw_while_braking])
def test_compiled_code_knows_no_unknown_kind(asked):
    with pytest.raises(IndexError):
        asked(len(CAPABILITIES))


@pytest.mark.parametrize("braking", [False, True])
def test_no_power_of_an_unknown_kind(braking):
    with pytest.raises(ValueError, match="there is no kernel for this kind of drive"):
        kernels.power_when_on(len(CAPABILITIES), np.ones(12), braking, 1e4, 10.0)
