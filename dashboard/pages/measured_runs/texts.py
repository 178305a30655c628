"""The numbers and sentences of the page Measured runs, as HTML."""

from railjoule.core.measured import MeasuredRun, Saving
from railjoule.dashboard.look import comparisons, words
from railjoule.dashboard.look.markup import Markup, joined, markup
from railjoule.dashboard.pages.measured_runs.compute import Measured, ReadRun, power_error
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.work.uploads import RUN_SUFFIXES

INVITATION = (
    "Drop the file of a run here, or choose it: CSV or XLSX with time and speed, better with position, effort and "
    "power."
)
ABOUT_EXAMPLE = (
    "The example is two runs over the line of Metro, profile II + I. This program simulated them with a slightly "
    "different train and wrote them down with the steps and errors of a recorder: nobody has measured them."
)
ACCEPTED = ",".join(RUN_SUFFIXES)


def invitation() -> Markup:
    """Return what a page without a file says."""
    lines = (
        markup("<p style='padding-top:8px;font-size:13.5px;max-width:80ch'>{}</p>", sentence)
        for sentence in (INVITATION, ABOUT_EXAMPLE)
    )
    return markup("<div role=status>{}</div>", joined(lines))


def subtitle(measured: Measured) -> str:
    """Return which run is shown."""
    read = measured.shown
    count = len(read.file.cells.rows)
    rows = f"{words.number(count, 0)} row{'' if count == 1 else 's'}"
    of = f"run {measured.number} of {len(measured.request.files)}"
    time = f", {words.time(read.run.recording.duration_s)} s" if read.run is not None else ""
    return f"{read.file.name}, {of}, {rows}{time}{_part_words(read.run)}"


def _part_words(run: MeasuredRun | None) -> str:
    """Return on which part of its line a run lies, if not on all of it."""
    if run is None or run.placement.is_whole_line:
        return ""
    place = run.placement
    start, end, line = (words.number(value, 0) for value in (place.start_m, place.end_m, place.line_m))
    return f", laid on {start} to {end} m of the line\u2019s {line} m"


def model_error(run: MeasuredRun) -> float | None:
    """Return the modelled energy over the measured one, less 1; None where no energy was measured."""
    measured = run.measured_kwh
    return run.modelled.energy_kwh / measured - 1 if measured is not None and measured > 0 else None


def figures(measured: Measured) -> Markup:
    """Return the row of numbers of the shown run."""
    run, saving = measured.shown.run, measured.saving
    assert run is not None
    return parts.figures([_saved(run, saving, measured.refusal), *_energies(run, saving), _power(run)])


def _saved(run: MeasuredRun, saving: Saving | None, refusal: str) -> Markup:
    if saving is None:
        return parts.figure("Could save", words.UNKNOWN, "", refusal or "being computed", "main")
    if saving.doubt:
        return parts.figure("Could save", words.UNKNOWN, "", saving.doubt, "main")
    modelled, optimum = run.modelled.energy_kwh, saving.optimum
    amount = comparisons.above(optimum.energy_kwh, modelled)
    low, high = (comparisons.above(modelled - end, modelled) for end in saving.interval_kwh)
    is_known = run.model_error_kwh is not None
    by = "speed and model" if is_known else "the speed; no measured energy shows that of the model"
    interval = f"{low.size} to {high.size} {high.unit} by the error of {by}"
    is_proven = optimum.is_proven and is_known
    proof = [Markup("<span class=proven>\u2713 proven for the modelled train</span>")] if is_proven else []
    less = f"{words.energy(saving.possible_kwh)} kWh less in {words.time(run.recording.duration_s)} s"
    detail = joined([interval, *proof, less], Markup("<br>"))
    whole = "Of the modelled energy: the same model tells both, so that most of its error cancels"
    return parts.figure("Could save", amount.size, amount.unit, detail, "main", whole=whole)


def _energies(run: MeasuredRun, saving: Saving | None) -> list[Markup]:
    measured, error = run.measured_kwh, model_error(run)
    how = "by the energy meter" if run.recording.energy_j is not None else "power summed over time"
    told = "the file has no power or energy" if measured is None else how
    against = "by the scenario\u2019s train" if error is None else f"{words.share_difference(error)} % against measured"
    cells = [
        parts.figure("Measured", words.UNKNOWN, "", told)
        if measured is None
        else parts.figure("Measured", words.energy(measured), "kWh", told),
        parts.figure("Modelled", words.energy(run.modelled.energy_kwh), "kWh", against),
    ]
    if saving is None:
        return [*cells, parts.figure("Optimal, same time", words.UNKNOWN, "", "")]
    proven = "proven within the tolerance" if saving.optimum.is_proven else "best run known of this model"
    return [*cells, parts.figure("Optimal, same time", words.energy(saving.optimum.energy_kwh), "kWh", proven)]


def _power(run: MeasuredRun) -> Markup:
    error = power_error(run)
    if error is None:
        return parts.figure("Model error in power", words.UNKNOWN, "", "no power was measured")
    return parts.figure("Model error in power", words.share(error), "%", "root mean square over time")


def columns_line(read: ReadRun) -> str:
    """Return how many columns are used."""
    asked = {doubt.header for doubt in read.doubts}
    used = [header for header, meaning in read.meanings.items() if meaning.quantity and header not in asked]
    return f"{len(used)} of {len(read.meanings)} columns used"


def where_block(measured: Measured) -> Markup:
    """Return where the shown run lies on the line, and what was done to its file."""
    read = measured.shown
    unused = [header for header, meaning in read.meanings.items() if not meaning.quantity]
    told = [*read.notes, *([f"Columns not used: {', '.join(unused)}."] if unused else [])]
    place = ""
    if read.run is not None:
        start, end = read.run.placement.start_m, read.run.placement.end_m
        line = read.run.scenario.line.name
        of = f" of the line {line}" if line else " of the scenario\u2019s line"
        place = f"{words.number(start, 0)} m to {words.number(end, 0)} m{of}"
    return markup(
        "<div class=block><h2>Where it ran <span class='muted small'>{}</span></h2>{}</div>",
        place,
        parts.note_paragraphs(told),
    )
