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
    return f"{read.file.name}, {of}, {rows}{time}"


def can_claim(run: MeasuredRun, saving: Saving) -> bool:
    """Return whether the model errs by less than it says could be saved."""
    error = model_error(run)
    return error is None or abs(error) < saving.possible_kwh / run.modelled.energy_kwh


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
    if not can_claim(run, saving):
        error = words.share(abs(model_error(run) or 0.0))
        detail = f"No saving can be claimed: the model is {error} % off. Fit the train below."
        return parts.figure("Could save", words.UNKNOWN, "", detail, "main")
    modelled, optimum = run.modelled.energy_kwh, saving.optimum
    amount = comparisons.above(optimum.energy_kwh, modelled)
    less = f"{words.energy(max(saving.possible_kwh, 0.0))} kWh less in {words.time(run.recording.duration_s)} s"
    proof = Markup("<span class=proven>\u2713 proven for the modelled train</span>") if optimum.is_proven else ""
    detail = joined([proof, less], Markup("<br>")) if proof else less
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
    proven = "no modelled run uses less" if saving.optimum.is_proven else "best run known of this model"
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
