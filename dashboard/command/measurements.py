"""What the commands `railjoule measured` and `railjoule fit` do with the files of a train's recorder."""

import argparse
import math
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

from railjoule.core.errors import RecordingError
from railjoule.core.identification import Fit, GaugeErrors, HeldOut, fit_runs, hold_out, monte_carlo_scenario
from railjoule.core.identification.fit import resistance_deviation
from railjoule.core.measured import MeasuredRun, RecorderFormat, Saving, load_run, possible_saving
from railjoule.core.scenario import Scenario, save_scenario
from railjoule.dashboard.command import commands, terminal
from railjoule.dashboard.command.commands import CommandError, Output
from railjoule.dashboard.command.summary import Summary
from railjoule.dashboard.look import comparisons, words

SCENARIO_SUFFIXES = (".toml",)


def measured(options: argparse.Namespace) -> None:
    """Show a measured run beside the model and the optimum, and write what is asked for.

    Raises
    ------
    RailjouleError
        If anything is wrong with the recording, the scenario or a file to write.
    """
    table = None if options.trajectory is None else commands.table_file(options.trajectory)
    target = None if options.output is None else commands.table_file(options.output, "-o", SCENARIO_SUFFIXES)
    scenario = _scenario(options)
    run = load_run(Path(options.run), scenario, _format(options), _start(options.start_m), options.sheet)
    saving, refusal = None, ""
    try:
        saving = possible_saving(run)
    except RecordingError as error:
        # the run itself is told all the same: what it lacks is a train that can drive it
        refusal = str(error)
    if table is not None:
        commands.write_table(run.trajectory.to_dataframe(), table, index=False)
    if target is not None:
        _write_scenario(run.scenario, target)
    Output(options.json).show(summarise_measured(run, saving, refusal), measured_text)


def fit(options: argparse.Namespace) -> None:
    """Show what runs tell of a train, and write the scenario with the fitted vehicle if it is asked for.

    Raises
    ------
    RailjouleError
        If anything is wrong with the recordings, the scenario or the file to write.
    """
    target = None if options.output is None else commands.table_file(options.output, "-o", SCENARIO_SUFFIXES)
    gauges = commands.quantities("--gauge", options.gauge)
    stated = GaugeErrors.from_percent({name: _number(f"--gauge {name}", text) for name, text in gauges.items()})
    scenario = _scenario(options)
    form, start = _format(options), _start(options.start_m)
    runs = [load_run(Path(name), scenario, form, start, options.sheet) for name in options.runs]
    found = fit_runs(runs, scenario, options.free, options.coasting, stated)
    held = hold_out(runs, scenario, options.free, options.coasting, stated)
    if target is not None:
        _write_scenario(monte_carlo_scenario(found, scenario), target)
    Output(options.json).show(summarise_fit(found, held, runs), fit_text)


def summarise_measured(run: MeasuredRun, saving: Saving | None, refusal: str) -> Summary:
    """Return a measured run as plain values; what is not known is None."""
    optimum = None if saving is None else saving.optimum
    notes = [*run.notes, *([refusal] if refusal else [])]
    interval = None if saving is None or not math.isfinite(saving.interval_kwh[0]) else list(saving.interval_kwh)
    return {
        "run": run.recording.name,
        "title": run.scenario.title,
        "measured_kwh": run.measured_kwh,
        "modelled_kwh": run.modelled.energy_kwh,
        "optimal_kwh": None if optimum is None else optimum.energy_kwh,
        "lower_bound_kwh": None if optimum is None else optimum.lower_bound_kwh,
        "gap": None if optimum is None else optimum.gap,
        "proven": optimum is not None and optimum.is_proven,
        "possible_saving_kwh": None if saving is None else saving.possible_kwh,
        "saving_interval_kwh": interval,
        "saving_doubt": "" if saving is None else saving.doubt,
        "model_error_kwh": run.model_error_kwh,
        "saving_at_most_kwh": None if saving is None else saving.at_most_kwh,
        "travel_time_s": run.modelled.travel_time_s,
        "distance_m": run.modelled.distance_m,
        "max_speed_kmh": run.modelled.max_speed_kmh,
        "start_m": run.placement.start_m,
        "end_m": run.placement.end_m,
        "line_m": run.placement.line_m,
        "is_whole_line": run.placement.is_whole_line,
        "scale": run.placement.scale,
        "stops": [
            {"name": stop.name, "position_m": stop.position_m, "dwell_s": stop.dwell_s}
            for stop in run.scenario.line.stations
        ],
        "notes": notes,
    }


def summarise_fit(found: Fit, held: Sequence[HeldOut], runs: Sequence[MeasuredRun]) -> Summary:
    """Return a fit as plain values."""
    names = [parameter.name for parameter in found.parameters]
    return {
        "runs": [run.recording.name for run in runs],
        "parameters": {
            parameter.name: {
                "value": parameter.value,
                "low": parameter.low,
                "high": parameter.high,
                "unit": parameter.unit,
                "before": found.model.first[parameter.name],
            }
            for parameter in found.parameters
        },
        "gauge_errors": {
            gauge.name: {"deviation": gauge.deviation, "error": gauge.error, "unit": gauge.unit}
            for gauge in found.gauge_errors
        },
        "contradiction": found.contradiction,
        "undetermined": list(found.undetermined),
        "sentences": list(found.sentences),
        "assumed": found.assumed,
        "residual_ms": found.residual_ms,
        "samples": found.step_count,
        "correlation": {
            name: dict(zip(names, row, strict=True))
            for name, row in zip(names, found.correlation.tolist(), strict=True)
        },
        "resistance_deviation": resistance_deviation(found),
        "held_out": [
            {
                "run": one.name,
                "residual_ms": one.residual_ms,
                "modelled_kwh": one.modelled_kwh,
                "measured_kwh": one.measured_kwh,
                "energy_error": one.energy_error,
            }
            for one in held
        ],
        "notes": [f"{run.recording.name}: {note}" for run in runs for note in run.notes],
    }


def measured_text(run: Summary) -> str:
    """Return a measured run for people."""
    labelled = terminal.labelled
    lines = [
        f"{terminal.printable(run['run'])}: {terminal.title_words(run['title'])}",
        f"{terminal.distance(run['distance_m'])} km in {terminal.time(run['travel_time_s'])} s, "
        f"at most {terminal.number(run['max_speed_kmh'])} km/h",
        "",
    ]
    if not run["is_whole_line"]:
        lines += labelled(
            "Place", f"from {run['start_m']:.0f} m to {run['end_m']:.0f} m of the line's {run['line_m']:.0f} m"
        )
    if run["measured_kwh"] is not None:
        lines += labelled("Measured", f"{terminal.energy(run['measured_kwh'])} kWh from the supply")
    lines += labelled("Modelled", f"{terminal.energy(run['modelled_kwh'])} kWh by the scenario at the measured speeds")
    if run["optimal_kwh"] is not None:
        proof = "proven optimal" if run["proven"] else _bound_words(run)
        told = f"{terminal.energy(run['optimal_kwh'])} kWh in the same time with the same stops, {proof}"
        lines += labelled("Optimal", told)
        lines += labelled("Saving", _saving_words(run))
    return "\n".join([*lines, "", *(line for note in run["notes"] for line in terminal.wrapped(note))])


def _saving_words(run: Summary) -> str:
    if run["saving_doubt"]:
        return str(run["saving_doubt"])
    _, amount = comparisons.saving(run["optimal_kwh"], run["modelled_kwh"])
    low, high = (terminal.energy(end) for end in run["saving_interval_kwh"])
    saved = f"{terminal.energy(run['possible_saving_kwh'])} kWh, {low} to {high} kWh by the errors of the speed"
    by_model = " and the model" if run["model_error_kwh"] is not None else "; that of the model is unknown"
    return f"{saved}{by_model}: the optimum saves {words.plain_text(str(amount))}"


def _bound_words(run: Summary) -> str:
    bound = run["lower_bound_kwh"]
    return "no bound known" if bound is None else f"bound {terminal.energy(bound)} kWh"


def fit_text(found: Summary) -> str:
    """Return a fit for people."""
    rows = [
        (
            name if name not in found["undetermined"] else f"{name} *",
            _digits(told["value"]),
            f"{_digits(told['low'])} to {_digits(told['high'])}",
            _digits(told["before"]),
            told["unit"],
        )
        for name, told in found["parameters"].items()
    ]
    head = ("parameter", "value", "95 % interval", "scenario", "unit")
    lines = [
        f"{len(found['runs'])} runs, {found['samples']} samples; simulated speed off by "
        f"{terminal.number(found['residual_ms'], 3)} m/s in the mean",
        "",
        *terminal.table_lines(head, rows, left={0, 4}),
        "",
        *(line for sentence in found["sentences"] for line in terminal.wrapped(f"* {sentence}")),
        *terminal.wrapped(found["assumed"]),
    ]
    if found["held_out"]:
        head = ("held out", "speed, m/s", "modelled, kWh", "measured, kWh", "error, %")
        lines += ["", *terminal.table_lines(head, [_held_row(one) for one in found["held_out"]])]
    else:
        lines += ["", "One run leaves none to hold out: a second one would show how well the fit predicts."]
    return "\n".join([*lines, "", *(line for note in found["notes"] for line in terminal.wrapped(note))])


def _held_row(one: Summary) -> tuple[str, ...]:
    error, energy = one["energy_error"], one["measured_kwh"]
    return (
        terminal.printable(str(one["run"])),
        terminal.number(one["residual_ms"], 3),
        terminal.energy(one["modelled_kwh"]),
        "" if energy is None else terminal.energy(energy),
        "" if error is None else terminal.number(100 * error, 2),
    )


def _digits(value: float) -> str:
    return f"{value:.4g}" if abs(value) < 1e4 else f"{value:.0f}"


def _scenario(options: argparse.Namespace) -> Scenario:
    if options.scenario is None:
        raise CommandError("--scenario is missing: a recording does not contain its line and its vehicle.")
    return commands.load(options.scenario, commands.parsed_changes(options.set))


def _format(options: argparse.Namespace) -> RecorderFormat:
    gap = RecorderFormat.longest_gap_s if options.longest_gap is None else _number("--longest-gap", options.longest_gap)
    columns = commands.quantities("--column", options.column)
    units = commands.quantities("--unit", options.unit)
    return RecorderFormat(options.preset, columns, units, gap, encoding=options.encoding)


def _start(text: str | None) -> float | None:
    return None if text is None else _number("--from", text)


def _number(option: str, text: str) -> float:
    with suppress(ValueError):
        return float(text)
    raise CommandError(f"{option} {commands.shortened(text)}: must be a number.")


def _write_scenario(scenario: Scenario, path: Path) -> None:
    with commands.failures_named(path):
        save_scenario(scenario, path)
