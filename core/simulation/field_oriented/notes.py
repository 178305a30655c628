"""What a closed-loop run says about itself: when limits held the machines back, and what it takes for granted."""

from collections.abc import Iterator

import numpy as np

from railjoule.core.arrays import BoolArray, FloatArray
from railjoule.core.drive.induction.traction import TractionMachines
from railjoule.core.scenario import Scenario
from railjoule.core.scenario.drive import Induction
from railjoule.core.simulation.field_oriented import states as column
from railjoule.core.simulation.field_oriented.flux import FluxPlan
from railjoule.core.simulation.field_oriented.record import Record
from railjoule.core.simulation.field_oriented.rolling_back import ROLLED_BACK_M
from railjoule.core.simulation.field_oriented.run import Saturation

# An arrival is measured so far before the end: the last decimetre is an asymptotic approach, whose time would
# say more about the tolerance of standing than about the run.
ARRIVAL_M = 0.1
# Limits at work less than the first apart are one event for a reader; alone, less than the second they are none, if
# the train does not notice them either. Smaller values list each sample of a noisy run.
GAP_S, SHORT_S = 1.0, 0.1
# A lag of this size is mentioned: the loop's own stays below it, a platform's marks are coarser.
NOTICEABLE_LAG_M = 0.05
# A current above its limit by more than this factor is mentioned; below it is the overshoot of a control that works.
OVERSHOOT = 1.02
# Weakening by less is rounding of the flux that the voltage allows.
WEAKENED_FRACTION = 1 - 1e-6
# Both accounts integrate the same stages, so what they differ by is the error of the steps of time.
ALLOWED_DIFFERENCE = 5e-4
ACCOUNTS_DIFFER = (
    "The energy of the input power and the sum of its parts differ by {:.2f} %: the simulation's time step is too long "
    "for the currents."
)


def saturations(record: Record) -> tuple[Saturation, ...]:
    """Return when limits held the machines back, in order of time."""
    spans: list[Saturation] = []
    for what, limited in (("current", column.CURRENT_LIMITED), ("voltage", column.VOLTAGE_LIMITED)):
        for first, last in _stretches(record.time_s, record.outputs[:, limited] > 0):
            # a flag stands for the steps since the sample before
            start, end = float(record.time_s[max(first - 1, 0)]), float(record.time_s[last])
            lag = float(np.max(record.tracking_error_m[first : last + 1]))
            if end - start >= SHORT_S or lag >= NOTICEABLE_LAG_M:
                spans.append(Saturation(start, end, what, lag))  # type: ignore[arg-type]
    return tuple(sorted(spans))


def _stretches(time_s: FloatArray, limited: BoolArray) -> list[tuple[int, int]]:
    """Return first and last samples of stretches in which a limit is at work, short gaps bridged."""
    at = np.flatnonzero(limited)
    if not len(at):
        return []
    gaps = np.flatnonzero(np.diff(time_s[at]) > GAP_S)
    return list(zip(at[np.append(0, gaps + 1)].tolist(), at[np.append(gaps, len(at) - 1)].tolist(), strict=True))


def run_notes(
    scenario: Scenario,
    machines: TractionMachines,
    flux: FluxPlan,
    record: Record,
    saturated: tuple[Saturation, ...],
    end_m: float,
) -> tuple[str, ...]:
    """Return the sentences on a run.

    Parameters
    ----------
    scenario : Scenario
        What was simulated.
    machines, flux : TractionMachines, FluxPlan
        The machines as they really are, and the flux requested of them.
    record, saturated : Record, tuple of Saturation
        The run, and when limits held it back.
    end_m : float
        Where it should stand [m].
    """
    return (
        *_premises(scenario, machines, flux),
        *_limit_notes(machines, record, saturated),
        *_motion_notes(record, end_m),
        *_control_notes(scenario),
    )


def accounts_note(record: Record, by_parts_j: FloatArray) -> tuple[str, ...]:
    """Return a sentence if input power and sum of parts do not agree at the end."""
    moved = record.final(column.DRAWN) + record.final(column.RETURNED)
    difference = abs(float(by_parts_j[-1]) - record.final(column.INPUT)) / max(moved, 1.0)
    return (ACCOUNTS_DIFFER.format(100 * difference),) if difference > ALLOWED_DIFFERENCE else ()


def _premises(scenario: Scenario, machines: TractionMachines, flux: FluxPlan) -> Iterator[str]:
    yield "The machines are magnetised before the departure; the account begins with it."
    if scenario.vehicle.braking.friction_effort_kn > 0:
        yield "The machines do all the braking: friction brakes are not part of the loop."
    if isinstance(scenario.vehicle.drive, Induction) and scenario.simulation.flux == "constant":
        yield "The control keeps the maximum flux that the voltage allows; the plan assumes the flux of minimum loss."
    if flux.lowest_fraction < WEAKENED_FRACTION:
        yield (
            f"The limit of {machines.machine.max_phase_voltage_v:.0f} V per phase weakens the flux to "
            f"{100 * flux.lowest_fraction:.0f} % of its rated value."
        )


def _limit_notes(machines: TractionMachines, record: Record, saturated: tuple[Saturation, ...]) -> Iterator[str]:
    limits = {
        "current": f"{machines.driving_current_a:g} A driving or {machines.braking_current_a:g} A braking",
        "voltage": f"{machines.machine.max_phase_voltage_v:.0f} V per phase",
    }
    for span in saturated:
        if abs(span.lag_m) < NOTICEABLE_LAG_M:
            continue
        behind = "behind" if span.lag_m > 0 else "ahead of"
        start_m = float(np.interp(span.start_s, record.time_s, record.position_m))
        yield (
            f"From {start_m:.0f} m, {span.start_s:.1f} s to {span.end_s:.1f} s, the {span.what} limit of "
            f"{limits[span.what]} holds the machines back; the train is up to {abs(span.lag_m):.2f} m {behind} "
            "the plan."
        )
    current, largest = record.extremes.current_a, max(machines.driving_current_a, machines.braking_current_a)
    if current > OVERSHOOT * largest:
        yield (
            f"The current reaches {current:.0f} A, above the limit of {largest:g} A, where the voltage limit or "
            "the speed noise prevents its control."
        )


def _motion_notes(record: Record, end_m: float) -> Iterator[str]:
    beyond = record.final(column.POSITION) - end_m
    if beyond > ARRIVAL_M:
        yield f"The train overshoots its end by {beyond:.1f} m: its machines do not brake as planned."
    farthest = np.maximum.accumulate(record.position_m)
    back = farthest - record.position_m
    deepest = int(np.argmax(back))
    if back[deepest] > ROLLED_BACK_M:
        yield (
            f"The train rolls back by up to {back[deepest]:.2f} m from {farthest[deepest]:.0f} m, "
            f"{record.time_s[deepest]:.1f} s: curves over distance show it standing there; its energy counts."
        )


def _control_notes(scenario: Scenario) -> Iterator[str]:
    factor = scenario.simulation.rotor_resistance_factor
    if factor != 1:
        yield f"The controller assumes {factor:g} times the true rotor resistance, so its flux axis is wrong."
