"""Numbers, sentences and tables of a run through the control loop."""

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.energy import share_above
from railjoule.core.simulation.field_oriented import FieldOrientedRun
from railjoule.core.studies.flux_sweep import FluxSweep
from railjoule.core.studies.table import StudyTable
from railjoule.core.units import J_PER_KWH, MS_PER_KMH
from railjoule.dashboard.look import comparisons, words
from railjoule.dashboard.look.markup import Markup, joined, markup
from railjoule.dashboard.parts import html as parts

SMALL_LENGTH_M = 0.1
LIMIT_WORDS = {"current": "The current limit", "voltage": "The voltage limit"}


def length(metres: float) -> tuple[str, str]:
    """Return a length as number and unit, a small one in millimetres."""
    if abs(metres) < SMALL_LENGTH_M:
        return words.number(1e3 * metres, 2), "mm"
    return words.number(metres, 2), "m"


def run_figures(run: FieldOrientedRun) -> list[str]:
    """Return the numbers of a run."""
    by_input, by_parts = (
        float(energy[-1]) / J_PER_KWH for energy in (run.energy_by_input_power_j, run.energy_by_parts_j)
    )
    magnetising = run.magnetising_loss_kwh
    # in millionths, as a percentage of so small a difference would read 0.00
    share = 1e6 * (by_parts / by_input - 1) if by_input else 0.0
    # both from the supply: the motors' net energy counts braking energy that the supply may not take back
    amount = comparisons.above(run.actual.energy_kwh, run.planned.energy_kwh)
    planned = words.energy(run.planned.energy_kwh)
    return [
        parts.figure(
            "Energy", words.energy(run.actual.energy_kwh), "kWh", f"{amount.sentence} the plan, {planned} kWh", "main"
        ),
        parts.figure(
            "Energy from input power",
            words.energy(by_input),
            "kWh",
            "all braking energy deducted",
            whole=f"The parts sum to it within {words.number(abs(share), 2)} ppm",
        ),
        parts.figure(
            "Magnetising loss",
            words.energy(magnetising),
            "kWh",
            f"{words.energy(run.paper_energy_kwh)} without it",
        ),
        parts.figure(
            "Tracking error", *length(run.max_tracking_error_m), f"{' '.join(length(run.stop_error_m))} at the end"
        ),
        parts.figure(
            "Peak current",
            words.number(run.max_current_a, 0),
            "A",
            f"torque {words.number(run.min_torque_current_a, 0)} to {words.number(run.max_torque_current_a, 0)}",
        ),
        parts.figure("Peak voltage", words.number(run.max_phase_voltage_v, 0), "V", "per phase"),
        parts.figure("Arrival error", words.delay(run.delay_s), "s", "against the plan", "extra"),
    ]


def held_words(run: FieldOrientedRun) -> Markup:
    """Return sentences on limits that held the drive and on its lag; nothing if none did."""
    rows = joined(
        markup(
            '<p class="note"><span class="open">{}</span> limited the motors from {} to {} s: {} behind the plan at '
            "most.</p>",
            LIMIT_WORDS[span.what],
            words.number(span.start_s),
            words.number(span.end_s),
            " ".join(length(max(span.lag_m, 0.0))),
        )
        for span in run.saturated
    )
    return markup('<div role="status" style="padding:0 20px 6px">{}</div>', rows) if rows else rows


def parts_table(run: FieldOrientedRun) -> Markup:
    """Return the parts of the energy, and their sum beside the integral of input power."""
    total = sum(run.parts_j.values())
    rows = [((words.PART_WORDS[name], *_amount(joules, total)), False) for name, joules in run.parts_j.items()]
    rows.append((("Sum of parts", *_amount(total, total)), True))
    by_input = float(run.energy_by_input_power_j[-1])
    rows.append((("Input power, integrated", *_amount(by_input, total)), True))
    return parts.inset(parts.table("Energy at the motors, by part", ("Part", "kWh", "%"), rows))


def _amount(joules: float, total: float) -> tuple[str, str]:
    return words.energy(joules / J_PER_KWH), words.share(joules / total if total else 0.0)


def flux_table(sweep: FluxSweep) -> str:
    """Return the numbers of three fluxes."""
    points = {
        "minimum loss": sweep.min_loss,
        "maximum within the voltage": sweep.within_voltage,
        "rated": sweep.rated,
    }
    rows = [
        (
            (
                name,
                words.number(point.flux_current_a),
                words.number(point.phase_voltage_v, 0),
                words.number(point.loss_w, 0),
                words.number(100 * point.efficiency),
                words.number(point.power_factor, 3),
            ),
            point is sweep.min_loss,
        )
        for name, point in points.items()
    ]
    speed, limit = words.number(sweep.speed_ms / MS_PER_KMH), words.number(sweep.max_phase_voltage_v, 0)
    title = f"One motor at {speed} km/h on level track, limit {limit} V"
    return parts.inset(parts.table(title, ("Flux", "A", "V", "loss, W", "efficiency, %", "power factor"), rows))


def detuning_cost(table: StudyTable) -> tuple[FloatArray, FloatArray]:
    """Return the factors that are computed, rising, and how much more energy each takes than the right one [%]."""
    factors = np.array(table.rotor_resistance_factor)
    right = table.energy_kwh[np.argmin(np.abs(factors - 1))]
    # before the right one is there, nothing can be told against it
    known = np.flatnonzero(np.isfinite(table.energy_kwh) & np.isfinite(right))
    # they come in the order of NEAREST_FIRST
    known = known[np.argsort(factors[known])]
    return factors[known], 100 * share_above(table.energy_kwh[known], float(right))


def detuning_table(table: StudyTable) -> str:
    """Return a table of the run with each factor that is computed."""
    rows = []
    for factor, more in zip(*detuning_cost(table), strict=True):
        k = table.rotor_resistance_factor.index(factor)
        cells = (
            f"{words.number(factor, 2)} \u00d7",
            words.share_difference(more / 100),
            words.number(table.max_current_a[k], 0),
            words.number(table.max_phase_voltage_v[k], 0),
            " ".join(length(table.max_tracking_error_m[k])),
        )
        rows.append((cells, factor == 1))
    title = "Controller with a wrong rotor resistance"
    header = ("Assumed / true", "energy, %", "peak, A", "peak, V", "tracking error")
    return parts.inset(parts.table(title, header, rows))
