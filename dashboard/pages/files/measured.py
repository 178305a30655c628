"""Measured runs: each file on its line, the best run in its time, and the train that fits all of them."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from railjoule.core import RailjouleError, Scenario
from railjoule.core.arrays import FloatArray
from railjoule.core.errors import RecordingError
from railjoule.core.identification import Fit, HeldOut, fit_runs, hold_out
from railjoule.core.identification.parameters import AUXILIARY, EFFICIENCY, MASS, MASS_FACTOR, RESISTANCE
from railjoule.core.measured import MeasuredRun, Recording, Saving, measured_run, possible_saving, to_recording
from railjoule.core.measured.columns import NAMES
from railjoule.core.scenario import Timetable
from railjoule.core.scenario._sentences import shown_list
from railjoule.dashboard.pages.files.columns import Meaning, Question, RunFile, settled, used_table

ANY_TIMETABLE = Timetable(travel_time_s=100.0)
"""A measured run brings its own: that of the scenario changes nothing."""
OPTION = re.compile(r" ?\(--[^)]*\)")
PARAMETER_WORDS: Mapping[str, str] = {
    RESISTANCE[0]: "A",
    RESISTANCE[1]: "B",
    RESISTANCE[2]: "C",
    MASS_FACTOR: "Rotating mass",
    MASS: "Mass",
    EFFICIENCY: "Efficiency",
    AUXILIARY: "Auxiliaries",
}
"""Names of fitted parameters on the page; the running resistance is A + B v + C v2."""


@dataclass(frozen=True)
class RunsRequest:
    """Files with the choices of the user, and the scenario with their train and line.

    Parameters
    ----------
    files : tuple of RunFile
    answers : tuple of (str, str)
        Meanings of columns by their names.
    scenario : Scenario
        Its timetable does not count.
    start_m : float or None
        Start of the runs on the line [m]; found if None.
    shown : str
        The file that the page shows; the last one where there is none of this name.
    coasting_only : bool
        Whether the fit takes only samples without effort.
    """

    files: tuple[RunFile, ...]
    answers: tuple[tuple[str, str], ...]
    scenario: Scenario
    start_m: float | None
    shown: str
    coasting_only: bool


@dataclass(frozen=True, eq=False)
class ReadRun:
    """A file as a run on its line, or the reason why it is none.

    Parameters
    ----------
    file : RunFile
    meanings : mapping of str to Meaning
        Meaning of each column.
    doubts : tuple of Question
        Questions about columns, which are not used until they are answered.
    run : MeasuredRun or None
        None where it cannot be laid on the line.
    refusal : str
        Why not.
    notes : tuple of str
        Assumptions, omissions and changes, in sentences.
    """

    file: RunFile
    meanings: Mapping[str, Meaning]
    doubts: tuple[Question, ...]
    run: MeasuredRun | None
    refusal: str
    notes: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class Measured:
    """All files of a request as far as they are read, the shown one with what it could have saved.

    Parameters
    ----------
    request : RunsRequest
    shown : ReadRun
        The file that the page shows.
    reads : tuple of ReadRun
        All that are read so far, in the order of the files.
    saving : Saving or None
        None if it is not computed yet, or if `refusal` has the reason against it.
    refusal : str
    fit : Fit or None
    held_out : tuple of HeldOut
        Each run by the fit to all others.
    refitted_kwh : float or None
        Energy of the shown run by the fitted train at the measured speeds.
    fit_refusal : str
        Why there is no fit.
    step : str
        The step under way; empty at the end.
    """

    request: RunsRequest
    shown: ReadRun
    reads: tuple[ReadRun, ...]
    saving: Saving | None = None
    refusal: str = ""
    fit: Fit | None = None
    held_out: tuple[HeldOut, ...] = ()
    refitted_kwh: float | None = None
    fit_refusal: str = ""
    step: str = ""

    @property
    def runs(self) -> list[MeasuredRun]:
        """The runs that are on their line."""
        return [read.run for read in self.reads if read.run is not None]

    @property
    def number(self) -> int:
        """Which of the files is shown, from 1 on."""
        return self.request.files.index(self.shown.file) + 1


def compute_measured(request: RunsRequest) -> Iterator[Measured]:
    """Yield what becomes of files: first the shown one, then what it could have saved, then all others and the fit."""
    scenario = request.scenario.model_copy(update={"timetable": ANY_TIMETABLE})
    shown = next((file for file in request.files if file.name == request.shown), request.files[-1])
    read = {shown: read_run(request, shown, scenario)}
    measured = Measured(request, read[shown], (read[shown],), step="Computing the optimum")
    yield measured
    run = read[shown].run
    if run is not None:
        try:
            measured = replace(measured, saving=possible_saving(run))
        except RailjouleError as error:
            measured = replace(measured, refusal=page_words(error))
    for number, file in enumerate(request.files, 1):
        yield replace(measured, step=f"Reading, {number} of {len(request.files)} files")
        if file not in read:
            read[file] = read_run(request, file, scenario)
        measured = replace(measured, reads=tuple(read[one] for one in request.files if one in read))
    yield replace(measured, step=f"Fitting the train to {len(measured.runs)} of {len(request.files)} runs")
    yield replace(with_fit(measured, scenario), step="")


def read_run(request: RunsRequest, file: RunFile, scenario: Scenario) -> ReadRun:
    """Return a file on the line of a scenario, or the reason against it."""
    meanings, doubts, assumed = settled(file, dict(request.answers), scenario.vehicle)
    asked = {doubt.header for doubt in doubts}
    used = {header: one for header, one in meanings.items() if one.quantity and header not in asked}
    run, refusal, notes = None, _missing(file, meanings, used), assumed
    if not refusal:
        try:
            recording = to_recording(*used_table(file, used))
            _require_time(recording)
            run = measured_run(recording, scenario, request.start_m)
            notes = (*notes, *(_without_options(note) for note in run.notes))
        except RailjouleError as error:
            refusal = page_words(error)
    return ReadRun(file, meanings, doubts, run, refusal, notes)


def _missing(file: RunFile, meanings: Mapping[str, Meaning], used: Mapping[str, Meaning]) -> str:
    """Return the name of a required column that is missing; empty if none is."""
    held, known = ({one.quantity for one in some.values()} for some in (meanings, used))
    for needed in (("speed",), ("time", "position")):
        if known & set(needed):
            continue
        if held & set(needed):
            return f"{file.name}: nothing is drawn before the question about the {needed[0]} is answered."
        names = shown_list(list(file.cells.header))
        return f"{file.name}: no column holds the {' or '.join(needed)}; say which one does. The file has {names}."
    twice = [one for one in NAMES if [meaning.quantity for meaning in used.values()].count(one) > 1]
    if twice:
        headers = [header for header, meaning in used.items() if meaning.quantity == twice[0]]
        return (
            f"{file.name}: {headers[0]} and {headers[1]} both hold the {twice[0].replace('_', ' ')}; use one of them."
        )
    if "effort" in known and known & {"tractive_effort", "braking_effort"}:
        return (
            f"{file.name}: one column holds the effort of driving and braking, and another one a part of it; use one."
        )
    return ""


def _require_time(recording: Recording) -> None:
    """Refuse samples at one time: without a column of it, those at the same place, as a rounded position has them."""
    if np.any(np.diff(recording.time_s) <= 0):
        raise RecordingError(
            f"{recording.name}: without a column of time the position must rise in each row of a train that moves."
        )


def with_fit(measured: Measured, scenario: Scenario) -> Measured:
    """Return the result with the train that fits its runs best, or the reason why there is none."""
    runs, coasting = measured.runs, measured.request.coasting_only
    if not runs:
        return measured
    try:
        fit = fit_runs(runs, scenario, coasting_only=coasting)
        shown = measured.shown.run
        refitted = None
        if shown is not None:
            again = measured_run(shown.recording, fit.fitted_scenario, shown.placement.start_m)
            refitted = again.modelled.energy_kwh
        held_out = hold_out(runs, scenario, coasting_only=coasting)
    except RailjouleError as error:
        return replace(measured, fit_refusal=page_words(error))
    return replace(measured, fit=fit, held_out=held_out, refitted_kwh=refitted)


def power_error(run: MeasuredRun) -> float | None:
    """Return the root mean square over time of modelled less measured power, over that of the measured power.

    None where no power was measured.
    """
    if run.measured is None or run.recording.power_w is None:
        return None
    modelled, measured = run.modelled.supply_power_w, run.measured.supply_power_w
    duration = np.diff(run.modelled.time_s)
    whole = float(measured**2 @ duration)
    return float(np.sqrt((modelled - measured) ** 2 @ duration / whole)) if whole > 0 else None


def energy_so_far(run: MeasuredRun) -> tuple[FloatArray, FloatArray, FloatArray] | None:
    """Return times [s], places [m] and measured energies since the start [J] of the samples; None without any.

    The meter goes before the power, as in `MeasuredRun.measured_kwh`.
    """
    recording = run.recording
    if recording.energy_j is not None and not np.isnan(recording.energy_j[0]):
        energy = recording.energy_j - recording.energy_j[0]
    elif recording.power_w is not None:
        power = recording.power_w
        energy = np.append(0.0, np.cumsum(0.5 * (power[1:] + power[:-1]) * np.diff(recording.time_s)))
    else:
        return None
    known = np.isfinite(energy)
    return recording.time_s[known], run.position_m[known], energy[known]


def fitted_changes(fit: Fit) -> dict[str, object]:
    """Return the changes of the scenario by a fit, by the keys of its file."""
    vehicle, free = fit.fitted_scenario.vehicle, set(fit.model.free)
    changes: dict[str, object] = {}
    if free & set(RESISTANCE):
        # each key of its own, zeros too: a whole table would leave what the preset has beside it
        before, after = fit.scenario.vehicle.resistance.model_dump(), vehicle.resistance.model_dump()
        changes |= {f"vehicle.resistance.{key}": value for key, value in after.items() if value != before[key]}
    if free & {MASS, MASS_FACTOR}:
        changes["vehicle.rotating_mass_factor"] = vehicle.rotating_mass_factor
        changes["vehicle.inertial_mass_kg"] = None
    if EFFICIENCY in free:
        changes[EFFICIENCY] = fit.values[EFFICIENCY]
    if AUXILIARY in free:
        changes[f"vehicle.{AUXILIARY}"] = vehicle.auxiliary_power_kw
    return changes


def fit_sentences(fit: Fit) -> list[str]:
    """Return the notes of a fit on parameters that the runs do not determine, in the words of the page."""
    return [_in_words(sentence) for sentence in fit.sentences]


def page_words(error: RailjouleError) -> str:
    """Return an error without the options of the command line, which the page does not have."""
    return _without_options(_in_words(str(error)))


def _without_options(sentence: str) -> str:
    return OPTION.sub("", sentence).replace("by --from", "under Begins at").replace("--from ", "Begins at ")


def _in_words(sentence: str) -> str:
    for key, word in PARAMETER_WORDS.items():
        sentence = sentence.replace(key, word)
    return sentence
