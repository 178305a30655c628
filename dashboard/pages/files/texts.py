"""The numbers and sentences of recorded runs, as HTML."""

from collections.abc import Mapping

from railjoule.core.identification import Fit, Parameter
from railjoule.core.identification.parameters import AUXILIARY, EFFICIENCY, MASS, MASS_FACTOR, RESISTANCE
from railjoule.core.measured import MeasuredRun, Saving
from railjoule.core.units import MS_PER_KMH
from railjoule.dashboard.look import comparisons, words
from railjoule.dashboard.look.markup import Markup, joined, markup
from railjoule.dashboard.pages.files.measured import PARAMETER_WORDS, Measured, ReadRun, fit_sentences, power_error
from railjoule.dashboard.parts import html as parts

INVITATION = {
    "line": (
        "Choose files or drop them anywhere on the page. Sheets, columns and units are recognised, and can be "
        "corrected; the scenario changes only when you press \u201cUse\u201d. The example is an invented line in "
        "the columns of SNCF.",
        ("File", "Contents", "Format"),
        (
            ("Gradients", "begin, end, gradient; also with signs up and down", "CSV, XLSX"),
            ("Heights", "position, height; or the points of a track", "CSV, XLSX, GPX"),
            ("Speed limits", "begin, end, limit; several classes of trains in one table", "CSV, XLSX"),
            ("Curves", "begin, end, radius or degree of curve", "CSV, XLSX"),
            ("Tunnels, neutral sections", "begin, end, tunnel factor", "CSV, XLSX"),
            ("Stations", "name, position, dwell or arrival and departure", "CSV, XLSX"),
            ("Track, train, journey", "as TTOBench publishes them", "JSON"),
            ("Scenario", "everything: saved or downloaded here, or within a report", "TOML, HTML"),
            ("Study", "saved on Explore", "NC"),
        ),
    ),
    "runs": (
        "Choose files or drop them anywhere on the page, CSV, XLSX or GPX. The page finds where the run lies on the "
        "line of the scenario, and its possible saving. The example is two runs, simulated with a slightly different "
        "train and the errors of a recorder: they are not measured.",
        ("Column", "Needed", "Units"),
        (
            ("Time", "yes", "s, hh:mm:ss, date and time"),
            ("Speed", "yes, unless there is a position", "km/h, m/s, mph"),
            ("Position", "better", "m, km"),
            ("Effort or brake", "better", "kN, %"),
            ("Power, energy, or current and voltage", "better", "kW, kWh, A, V"),
        ),
    ),
}
"""The first sentences of a tab without a file, and the table of what it takes: its head and its rows."""
FIT_CSS = """
.fit td:first-child span { color: var(--rj-ink3); font-size: 11px; }
.fit svg { margin: 0; vertical-align: middle; }
.warm { color: var(--rj-overline); font-weight: 600; }
.block p + p { margin-top: 6px; }
@media (max-width: 899px) { .fit tr { display: grid; grid-template-columns: 1fr 48px 104px 62px; }
  .fit td:last-child { grid-column: 1 / 5; padding: 0 0 6px; border-top: 0; } .fit td, .fit th { white-space: normal; }
  .fit th:last-child { display: none; } .fit svg { width: 100%; } }
"""
BAR_PX, EDGE = 130, 6.0
"""Width of a bar, and which share of it is left free at its ends [%]."""


SHOWN: Mapping[str, tuple[str, float, int]] = {
    RESISTANCE[0]: ("kN", 1000.0, 2),
    RESISTANCE[1]: ("N per km/h", 1.0, 1),
    RESISTANCE[2]: ("N per (km/h)\u00b2", 1.0, 2),
    MASS_FACTOR: ("% of the mass", 0.01, 2),
    MASS: ("t", 1000.0, 1),
    EFFICIENCY: ("%", 0.01, 1),
    AUXILIARY: ("kW", 1.0, 2),
}
"""Of each parameter its unit in words, the size of that in the unit of the file, and the decimals."""


def subtitle(measured: Measured) -> str:
    """Return the name of the shown run."""
    read = measured.shown
    count = len(read.file.cells.rows)
    rows = f"{words.number(count, 0)} row{'' if count == 1 else 's'}"
    of = f"run {measured.number} of {len(measured.request.files)}"
    time = f", {words.time(read.run.recording.duration_s)} s" if read.run is not None else ""
    return f"{read.file.name}, {of}, {rows}{time}{_part_words(read.run)}"


def _part_words(run: MeasuredRun | None) -> str:
    """Return the part of its line that a run covers, if it is not all of it."""
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
        return parts.figure("Potential saving", words.UNKNOWN, "", refusal or "being computed", "main")
    if saving.doubt:
        return parts.figure("Potential saving", words.UNKNOWN, "", saving.doubt, "main")
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
    whole = "Share of the modelled energy: both energies come from the same model, so most of its error cancels"
    return parts.figure("Potential saving", amount.size, amount.unit, detail, "main", whole=whole)


def _energies(run: MeasuredRun, saving: Saving | None) -> list[Markup]:
    measured, error = run.measured_kwh, model_error(run)
    how = "by the energy meter" if run.recording.energy_j is not None else "power summed over time"
    source = "the file has no power or energy" if measured is None else how
    against = "by the scenario\u2019s train" if error is None else f"{words.share_difference(error)} % against measured"
    cells = [
        parts.figure("Measured", words.UNKNOWN, "", source)
        if measured is None
        else parts.figure("Measured", words.energy(measured), "kWh", source),
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
    """Return the number of used columns."""
    asked = {doubt.header for doubt in read.doubts}
    used = [header for header, meaning in read.meanings.items() if meaning.quantity and header not in asked]
    return f"{len(used)} of {len(read.meanings)} columns used"


def where_block(measured: Measured) -> Markup:
    """Return the stretch of the shown run on the line, and the notes on its file."""
    read = measured.shown
    unused = [header for header, meaning in read.meanings.items() if not meaning.quantity]
    notes = [*read.notes, *([f"Columns not used: {', '.join(unused)}."] if unused else [])]
    place = ""
    if read.run is not None:
        start, end = read.run.placement.start_m, read.run.placement.end_m
        line = read.run.scenario.line.name
        of = f" of the line {line}" if line else " of the scenario\u2019s line"
        place = f"{words.number(start, 0)} m to {words.number(end, 0)} m{of}"
    return markup(
        "<div class=block><h2>Stretch of the line <span class='muted small'>{}</span></h2>{}</div>",
        place,
        parts.note_paragraphs(notes),
    )


def fit_block(measured: Measured) -> Markup:
    """Return the fit of a request, or its present state."""
    runs = measured.runs
    minutes = sum(run.recording.duration_s for run in runs) / 60
    count = f"{len(runs)} run{'' if len(runs) == 1 else 's'}, {words.number(minutes, 1)} min" if runs else ""
    title = markup("<h2>Fit the train to these runs <span class='muted small'>{}</span></h2>", count)
    return markup("<div class='block fit'>{}{}</div>", title, _body(measured))


def _body(measured: Measured) -> Markup:
    if measured.fit is not None:
        return _table(measured.fit) + _sentences(measured, measured.fit)
    if measured.fit_refusal:
        return parts.note_paragraphs([measured.fit_refusal])
    return parts.note_paragraphs([f"{measured.step}." if measured.step else "No run can be fitted."])


def _table(fit: Fit) -> Markup:
    warm = {*fit.undetermined, *(name for group in fit.confounded for name in group)}
    head = ("Quantity", "fitted", "95 % interval", "in the scenario", "as a bar")
    return parts.plain_table(head, [(_row(fit, one, one.name in warm), False) for one in fit.parameters], "fit")


def _row(fit: Fit, parameter: Parameter, is_warm: bool) -> tuple[str, ...]:
    (unit, factor, digits), now = SHOWN[parameter.name], fit.model.first[parameter.name]
    value, low, high, before = (
        words.number(number / factor, digits) for number in (parameter.value, parameter.low, parameter.high, now)
    )
    return (
        markup("{} <span>{}</span>", PARAMETER_WORDS[parameter.name], unit),
        markup("<b>{}</b>", value),
        markup("<span class='{}'>{} to {}</span>", "warm" if is_warm else "", low, high),
        before,
        _bar(parameter, now, is_warm, f"{before} {unit}"),
    )


def _bar(parameter: Parameter, now: float, is_warm: bool, label: str) -> Markup:
    """Return interval and value as a bar and a dot, the scenario's value as a tick."""
    ends = (parameter.low, parameter.value, parameter.high, now)
    first, length = min(ends), max(max(ends) - min(ends), 1e-12)
    low, value, high, tick = (EDGE + (100 - 2 * EDGE) * (one - first) / length for one in ends)
    return markup(
        # shares of the width, so that it may be as wide as its place and the dot stays round
        "<svg width='{width}' height='18' role='img' aria-label='value now in the scenario: {label}'>"
        "<rect y='8.5' width='100%' height='1' fill='var(--rj-line)'/>"
        "<rect x='{low}%' y='6' width='{wide}%' height='6' rx='3' fill='{colour}' fill-opacity='.35'/>"
        "<circle cx='{value}%' cy='9' r='4' fill='{colour}'/>"
        "<rect x='{tick}%' y='2' width='2' height='14' fill='var(--rj-ink)'/></svg>",
        width=BAR_PX,
        label=label,
        low=f"{low:.1f}",
        wide=f"{max(high - low, 1.0):.1f}",
        value=f"{value:.1f}",
        tick=f"{tick:.1f}",
        colour="var(--rj-overline)" if is_warm else "var(--rj-accent)",
    )


def _sentences(measured: Measured, fit: Fit) -> Markup:
    warm = joined(markup("<p class=note><span class=warm>{}</span></p>", one) for one in fit_sentences(fit))
    sentences = [
        "Running resistance is A + B v + C v\u00b2. The tick is the value now in the scenario. Simulated and measured "
        f"speed differ by {words.number(fit.residual_ms / MS_PER_KMH, 2)} km/h (root mean square).",
        fit.assumed,
    ]
    run = measured.shown.run
    if run is not None and run.measured_kwh and measured.refitted_kwh is not None:
        after, before = (kwh / run.measured_kwh - 1 for kwh in (measured.refitted_kwh, run.modelled.energy_kwh))
        sentences.append(
            f"Error in the energy of {measured.shown.file.name} with the fitted train: {words.share_difference(after)} "
            f"%, with the scenario\u2019s: {words.share_difference(before)} %."
        )
    held = [
        f"{one.name} {words.share_difference(one.energy_error)} %"
        for one in measured.held_out
        if one.energy_error is not None
    ]
    if held:
        sentences.append(f"Error in the energy of each run by a fit to only the others: {', '.join(held)}.")
    return warm + parts.note_paragraphs(sentences)
