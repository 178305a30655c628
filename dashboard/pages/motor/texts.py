"""Numbers, sentences and tables of a run through the control loop."""

from collections.abc import Mapping

from railjoule.core.simulation.field_oriented import FieldOrientedRun
from railjoule.core.studies.flux_sweep import FluxSweep
from railjoule.core.units import J_PER_KWH, MS_PER_KMH
from railjoule.dashboard.look import comparisons, words
from railjoule.dashboard.look.markup import Markup, joined, markup
from railjoule.dashboard.pages.motor.compute import RIVALS, limits_of
from railjoule.dashboard.parts import html as parts

SMALL_LENGTH_M = 0.1
# as assets/css/parts.css leaves columns out on narrow screens
FEWER_COLUMNS = Markup('<p class="note fewer-columns">A wider screen shows magnetising loss and peak voltage, too.</p>')
FLUX_WORDS = {"constant": "constant rotor flux", "min_loss": "rotor flux of least loss"}
LIMIT_WORDS = {"current": "The current limit", "voltage": "The voltage limit"}


def length(metres: float) -> tuple[str, str]:
    """Return a length as number and unit, a small one in millimetres."""
    if abs(metres) < SMALL_LENGTH_M:
        return words.number(1e3 * metres, 2), "mm"
    return words.number(metres, 2), "m"


def finding(run: FieldOrientedRun, other_flux: FieldOrientedRun | None = None) -> Markup:
    """Return the finding in numbers: energy against the plan, the use of the inverter, and the other rotor flux."""
    more, planned_kwh = comparisons.above(run.actual.energy_kwh, run.planned.energy_kwh), run.planned.energy_kwh
    voltage, current = (words.number(100 * share, 0) for share in _use(run))
    flux = ""
    if other_flux is not None:
        change = comparisons.above(other_flux.actual.energy_kwh, run.actual.energy_kwh)
        needs = f"{words.energy(other_flux.actual.energy_kwh)} kWh, {change.size} {change.unit}"
        name = FLUX_WORDS[other_flux.scenario.simulation.flux].capitalize()
        flux = f"{name}, a choice of the sidebar, needs {needs} {'less' if change.is_less else 'more'}."
    return parts.finding(
        f"With its motors under control, the train needs {words.energy(run.actual.energy_kwh)} kWh, {more.sentence} "
        f"the plan\u2019s {words.energy(planned_kwh)} kWh; magnetising the motors takes "
        f"{words.energy(run.magnetising_loss_kwh)} kWh. "
        f"The inverter gives up to {voltage} % of its voltage and {current} % of its current.",
        flux,
    )


def _use(run: FieldOrientedRun) -> tuple[float, float]:
    """Return peak voltage and current over the limits of the inverter."""
    volts, amperes = (limits_of(run.scenario) or {}).values()
    return run.max_phase_voltage_v / volts, run.max_current_a / amperes


def run_figures(run: FieldOrientedRun) -> list[str]:
    """Return the numbers of a run."""
    # both from the supply: the motors' net energy counts braking energy that the supply may not take back
    amount = comparisons.above(run.actual.energy_kwh, run.planned.energy_kwh)
    planned, without = words.energy(run.planned.energy_kwh), words.energy(run.paper_energy_kwh)
    at_end = f"{' '.join(length(run.stop_error_m))}, {words.delay(run.delay_s)} s at the end"
    volts, amperes = (f"limit {words.number(limit, 0)}" for limit in (limits_of(run.scenario) or {}).values())
    return [
        parts.figure(
            "Energy", words.energy(run.actual.energy_kwh), "kWh", f"{amount.sentence} the plan, {planned} kWh", "main"
        ),
        parts.figure("Magnetising loss", words.energy(run.magnetising_loss_kwh), "kWh", f"{without} without it"),
        parts.figure("Tracking error", *length(run.max_tracking_error_m), at_end),
        parts.figure("Peak current", words.number(run.max_current_a, 0), "A", amperes),
        parts.figure("Peak voltage", words.number(run.max_phase_voltage_v, 0), "V", volts),
    ]


def rivals_table(runs: Mapping[str, FieldOrientedRun]) -> Markup:
    """Return a run beside those with which it is compared, by their names in `LoopRivals`."""
    run, flux = runs["run"], runs["other flux"].scenario.simulation.flux
    ahead = run.scenario.simulation.precompensator
    named = {
        f"This run, {words.strategy(run.planned.strategy)}": run,
        f"with {FLUX_WORDS[flux]}": runs["other flux"],
        "without pre-compensator" if ahead else "with pre-compensator": runs["without" if ahead else "with"],
        **{f"by {words.strategy(name)}": runs[name] for name in RIVALS if runs.get(name, run) is not run},
    }
    rows = [
        (
            (
                name,
                words.energy(one.actual.energy_kwh),
                words.energy(one.magnetising_loss_kwh),
                comparisons.above(one.actual.energy_kwh, run.actual.energy_kwh).cell,
                " ".join(length(one.max_tracking_error_m)),
                words.number(one.max_current_a, 0),
                words.number(one.max_phase_voltage_v, 0),
            ),
            one is run,
        )
        for name, one in named.items()
    ]
    head = ("Run", "kWh", "magnetising, kWh", "vs this run, %", "tracking error", "peak A", "peak V")
    table = '<div class="wide-table wraps" tabindex="0" role="region" aria-label="Compared runs">{}</div>{}'
    body = markup(table, parts.table("Compared runs", head, rows), FEWER_COLUMNS)
    return markup('<div style="padding:0 20px 10px">{}</div>', body)


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
    """Return the parts of the energy that are not zero, and their sum, the integral of input power."""
    total = float(run.energy_by_input_power_j[-1])
    shown = {name: joules for name, joules in run.parts_j.items() if abs(joules) >= words.LEAST_ENERGY_KWH * J_PER_KWH}
    rows = [((words.PART_WORDS[name], *_amount(joules, total)), False) for name, joules in shown.items()]
    rows.append((("All", *_amount(total, total)), True))
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
