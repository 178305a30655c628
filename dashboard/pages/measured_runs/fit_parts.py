"""The fit of a train to its runs, as a table of values with their intervals."""

from collections.abc import Mapping
from dataclasses import dataclass

from railjoule.core.identification import Fit, Parameter
from railjoule.core.identification.parameters import AUXILIARY, EFFICIENCY, MASS, MASS_FACTOR, RESISTANCE
from railjoule.core.units import MS_PER_KMH
from railjoule.dashboard.look import words
from railjoule.dashboard.look.markup import Markup, joined, markup
from railjoule.dashboard.pages.measured_runs.compute import PARAMETER_WORDS, Measured, fit_sentences
from railjoule.dashboard.parts import html as parts

WIDTH_PX, EDGE = 130, 6.0
"""Of a bar, and which share of it is left free at its ends [%]."""
FIT_CSS = """
.fit td:first-child { min-width: 0; }
.fit td:first-child span { display: block; color: var(--rj-ink3); font-size: 11px; }
.fit .open { font-weight: 500; }
.fit svg { margin: 0; vertical-align: middle; }
.fit th:last-child { text-align: left; padding-left: 14px; }
.warm { color: var(--rj-overline); font-weight: 600; }
.block p + p { margin-top: 6px; }
@media (max-width: 899px) { .fit tr { display: grid; grid-template-columns: 1fr auto auto; }
  .fit td.bar { grid-column: 1 / 4; padding: 0 0 6px; } .fit td + td { border-top: 0; }
  .fit thead { display: none; } .fit td { border-top: 0; } .fit tr { border-top: 1px solid var(--rj-line); }
  .fit .bar svg { width: 100%; } }
"""


@dataclass(frozen=True)
class Shown:
    """How a parameter is shown: its unit in words, what one of that is in the file's unit, and its decimals."""

    unit: str
    factor: float
    digits: int


SHOWN: Mapping[str, Shown] = {
    RESISTANCE[0]: Shown("kN", 1000.0, 2),
    RESISTANCE[1]: Shown("N per km/h", 1.0, 1),
    RESISTANCE[2]: Shown("N per (km/h)\u00b2", 1.0, 2),
    MASS_FACTOR: Shown("% of the mass", 0.01, 2),
    MASS: Shown("t", 1000.0, 1),
    EFFICIENCY: Shown("%", 0.01, 1),
    AUXILIARY: Shown("kW", 1.0, 2),
}


def fit_block(measured: Measured) -> Markup:
    """Return the fit of a request, or what is known of it so far."""
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
    head = "<tr><th scope=col>Quantity<th scope=col>fitted<th scope=col>95 % interval<th scope=col>"
    rows = joined(_row(fit, parameter, parameter.name in warm) for parameter in fit.parameters)
    return markup("<table><thead>{}<tbody>{}</table>", Markup(head), rows)


def _row(fit: Fit, parameter: Parameter, is_warm: bool) -> Markup:
    shown, now = SHOWN[parameter.name], fit.model.first[parameter.name]
    value, low, high = (
        words.number(number / shown.factor, shown.digits) for number in (parameter.value, parameter.low, parameter.high)
    )
    return markup(
        "<tr><td>{} <span>{}</span><td>{}<td class='{}'>{} to {}<td class=bar>{}",
        PARAMETER_WORDS[parameter.name],
        shown.unit,
        markup("<b>{}</b>", value),
        "warm" if is_warm else "",
        low,
        high,
        _bar(parameter, now, is_warm, f"{words.number(now / shown.factor, shown.digits)} {shown.unit}"),
    )


def _bar(parameter: Parameter, now: float, is_warm: bool, told: str) -> Markup:
    """Return interval and value as a bar and a dot, the scenario's value as a tick."""
    ends = (parameter.low, parameter.value, parameter.high, now)
    first, length = min(ends), max(max(ends) - min(ends), 1e-12)
    low, value, high, tick = (EDGE + (100 - 2 * EDGE) * (one - first) / length for one in ends)
    return markup(
        # shares of the width, so that it may be as wide as its place and the dot stays round
        "<svg width='{width}' height='18' role='img' aria-label='value now in the scenario: {told}'>"
        "<rect y='8.5' width='100%' height='1' fill='var(--rj-line)'/>"
        "<rect x='{low}%' y='6' width='{wide}%' height='6' rx='3' fill='{colour}' fill-opacity='.35'/>"
        "<circle cx='{value}%' cy='9' r='4' fill='{colour}'/>"
        "<rect x='{tick}%' y='2' width='2' height='14' fill='var(--rj-ink)'/></svg>",
        width=WIDTH_PX,
        told=told,
        low=f"{low:.1f}",
        wide=f"{max(high - low, 1.0):.1f}",
        value=f"{value:.1f}",
        tick=f"{tick:.1f}",
        colour="var(--rj-overline)" if is_warm else "var(--rj-accent)",
    )


def _sentences(measured: Measured, fit: Fit) -> Markup:
    warm = joined(markup("<p class=note><span class=warm>{}</span></p>", told) for told in fit_sentences(fit))
    told = [
        "Running resistance is A + B v + C v\u00b2. The tick is the value now in the scenario. Simulated and measured "
        f"speed differ by {words.number(fit.residual_ms / MS_PER_KMH, 2)} km/h (root mean square).",
        fit.assumed,
    ]
    run = measured.shown.run
    if run is not None and run.measured_kwh and measured.refitted_kwh is not None:
        after, before = (kwh / run.measured_kwh - 1 for kwh in (measured.refitted_kwh, run.modelled.energy_kwh))
        told.append(
            f"Error in the energy of {measured.shown.file.name} with the fitted train: {words.share_difference(after)} "
            f"%, with the scenario\u2019s: {words.share_difference(before)} %."
        )
    held = [
        f"{one.name} {words.share_difference(one.energy_error)} %"
        for one in measured.held_out
        if one.energy_error is not None
    ]
    if held:
        told.append(f"Error in the energy of each run by a fit to the others alone: {', '.join(held)}.")
    return warm + parts.note_paragraphs(told)
