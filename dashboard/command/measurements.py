"""Commands `railjoule measured` and `railjoule fit`, for the files of a train's recorder."""

import argparse
import math
from collections.abc import Sequence
from pathlib import Path

from railjoule.core.errors import RecordingError
from railjoule.core.identification import Fit, GaugeErrors, HeldOut, fit_runs, hold_out, monte_carlo_scenario
from railjoule.core.identification.fit import resistance_deviation
from railjoule.core.measured import MeasuredRun, RecorderFormat, Saving, load_run, possible_saving
from railjoule.core.scenario import format_scenario
from railjoule.dashboard.command import files, terminal
from railjoule.dashboard.command.summary import Summary, picked
from railjoule.dashboard.command.values import printable
from railjoule.dashboard.look import comparisons, words

RECORDED = "a recording does not contain its line and its vehicle"


def measured(options: argparse.Namespace) -> None:
    """Show a measured run beside the model and the optimum, and write what is asked for."""
    run = load_run(Path(options.run), files.scenario(options, RECORDED), form(options), options.start_m, options.sheet)
    saving, refusal = None, ""
    try:
        saving = possible_saving(run)
    except RecordingError as error:
        # the run itself is reported all the same: it only lacks a train that can drive it
        refusal = str(error)
    if options.trajectory is not None:
        files.write_table(run.trajectory.to_dataframe(), options.trajectory)
    if options.output is not None:
        files.write(options.output, format_scenario(run.scenario))
    files.show(options, summarise_measured(run, saving, refusal), measured_text)


def fit(options: argparse.Namespace) -> None:
    """Show what runs tell of a train, and write the scenario with the fitted vehicle if it is asked for."""
    stated = GaugeErrors.from_percent(dict(options.gauge))
    scenario, recorder = files.scenario(options, RECORDED), form(options)
    runs = [load_run(Path(name), scenario, recorder, options.start_m, options.sheet) for name in options.runs]
    found = fit_runs(runs, scenario, options.free, options.coasting, stated)
    held = hold_out(runs, scenario, options.free, options.coasting, stated)
    if options.output is not None:
        files.write(options.output, format_scenario(monte_carlo_scenario(found, scenario)))
    files.show(options, summarise_fit(found, held, runs), fit_text)


def form(options: argparse.Namespace) -> RecorderFormat:
    """Return how a recorder writes its files, as the options say."""
    return RecorderFormat(
        options.preset, dict(options.column), dict(options.unit), options.longest_gap, encoding=options.encoding
    )


def summarise_measured(run: MeasuredRun, saving: Saving | None, refusal: str) -> Summary:
    """Return a measured run as plain values; what is not known is None."""
    optimum = None if saving is None else saving.optimum
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
        **picked(run.modelled, "travel_time_s", "distance_m", "max_speed_kmh"),
        **picked(run.placement, "start_m", "end_m", "line_m", "is_whole_line", "scale"),
        "stops": [picked(stop, "name", "position_m", "dwell_s") for stop in run.scenario.line.stations],
        "notes": [*run.notes, *filter(None, [refusal])],
    }


def summarise_fit(found: Fit, held: Sequence[HeldOut], runs: Sequence[MeasuredRun]) -> Summary:
    """Return a fit as plain values."""
    names = [parameter.name for parameter in found.parameters]
    correlation = zip(names, found.correlation.tolist(), strict=True)
    return {
        "runs": [run.recording.name for run in runs],
        "parameters": {
            parameter.name: {
                **picked(parameter, "value", "low", "high", "unit"),
                "before": found.model.first[parameter.name],
            }
            for parameter in found.parameters
        },
        "gauge_errors": {gauge.name: picked(gauge, "deviation", "error", "unit") for gauge in found.gauge_errors},
        "contradiction": found.contradiction,
        "undetermined": list(found.undetermined),
        "sentences": list(found.sentences),
        "assumed": found.assumed,
        "residual_ms": found.residual_ms,
        "samples": found.step_count,
        "correlation": {name: dict(zip(names, row, strict=True)) for name, row in correlation},
        "resistance_deviation": resistance_deviation(found),
        "held_out": [
            {"run": one.name, **picked(one, "residual_ms", "modelled_kwh", "measured_kwh", "energy_error")}
            for one in held
        ],
        "notes": [f"{run.recording.name}: {note}" for run in runs for note in run.notes],
    }


def measured_text(run: Summary) -> str:
    """Return a measured run for people."""
    labelled = terminal.labelled
    lines = [
        f"{printable(run['run'])}: {terminal.title_words(run['title'])}",
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
        bound = run["lower_bound_kwh"]
        bounded = "no bound known" if bound is None else f"bound {terminal.energy(bound)} kWh"
        proof = "proven optimal" if run["proven"] else bounded
        optimal = f"{terminal.energy(run['optimal_kwh'])} kWh in the same time with the same stops, {proof}"
        lines += labelled("Optimal", optimal)
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


def fit_text(found: Summary) -> str:
    """Return a fit for people."""
    rows = [
        (
            name if name not in found["undetermined"] else f"{name} *",
            _digits(row["value"]),
            f"{_digits(row['low'])} to {_digits(row['high'])}",
            _digits(row["before"]),
            row["unit"],
        )
        for name, row in found["parameters"].items()
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
        printable(str(one["run"])),
        terminal.number(one["residual_ms"], 3),
        terminal.energy(one["modelled_kwh"]),
        "" if energy is None else terminal.energy(energy),
        "" if error is None else terminal.number(100 * error, 2),
    )


def _digits(value: float) -> str:
    return f"{value:.4g}" if abs(value) < 1e4 else f"{value:.0f}"
