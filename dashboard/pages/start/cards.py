"""The pictures of Start: the optimum beside the fastest run, and a card for each shipped scenario."""

import numpy as np

from railjoule.core import Trajectory
from railjoule.core.arrays import FloatArray
from railjoule.core.units import MS_PER_KMH
from railjoule.dashboard.charts.surface import round_step
from railjoule.dashboard.look import comparisons, words
from railjoule.dashboard.look.markup import Markup, joined, markup
from railjoule.dashboard.look.tokens import variable
from railjoule.dashboard.page_list import PAGES
from railjoule.dashboard.pages.start.compute import GOOD_FOR, Card
from railjoule.dashboard.work.runs import Runs

WIDTH, HEIGHT = 1000.0, 240.0
SMALL_WIDTH, SMALL_HEIGHT = 240.0, 54.0
MAX_POINTS, MOST_TICKS = 160, 6
SKETCHED_LINE = Markup(
    '<path d="M2 53 C 8 20 14 8 32 8 L 196 8 C 222 8 232 30 238 53" fill="none" stroke="var(--rj-line2)" '
    'stroke-width="1.8" vector-effect="non-scaling-stroke"/>'
)
HERO_SKETCH = Markup(
    '<path d="M0 9.6 C.3 4 .6 1.5 1.6 1.5 L8 1.5 C9.2 1.5 9.6 5 10 9.6 M0 9.7 H10" fill="none" '
    'stroke="var(--rj-line2)" stroke-width="2" vector-effect="non-scaling-stroke"/>'
)
LEAD = (
    "railjoule finds the run of a rail vehicle that needs the least energy for a given time, and proves how far it can "
    "be from the best possible."
)
MORE = "Move the travel time and see what the driver has to do, and how much more other strategies need."
BUTTONS = Markup(
    '<div class="asks"><button type="button" class="text-button" data-open="Drive">Drive this train</button>'
    '<button type="button" class="text-button" data-open="Files">Use your own line, train or file</button>'
    '<button type="button" class="text-button" data-open="Learn">Learn why coasting saves energy</button></div>'
)


def hero(runs: Runs | None) -> Markup:
    """Return the sentence, and the picture of the present optimum beside the fastest run once it is there."""
    text = markup("<h1>{}</h1><p>{} {}</p>{}", PAGES["Start"].question, LEAD, MORE, BUTTONS)
    if runs is None:
        return markup(
            '<div class="hero">{}<svg role="img" aria-label="Being computed: the first run" viewBox="0 0 10 10" '
            'preserveAspectRatio="none">{}</svg><div class="key">Computing</div></div>',
            text,
            HERO_SKETCH,
        )
    run, fastest = runs.best, runs.runs.get("fastest")
    phases = dict.fromkeys(phase.phase for phase in run.phases)
    energy_and_time = (words.energy(run.energy_kwh), words.time(run.travel_time_s))
    key = [
        markup("<span><b>{}</b>, {} km</span>", run.scenario.title, words.distance(run.distance_m)),
        markup("<span>{}: <b>{} kWh</b> in {} s</span>", words.strategy(run.strategy), *energy_and_time),
    ]
    if fastest is not None:
        energy_and_time = (words.energy(fastest.energy_kwh), words.time(fastest.travel_time_s))
        key.append(markup("<span>dotted: fastest possible, {} kWh in {} s</span>", *energy_and_time))
    patch = '<span><i style="background:var(--rj-{})"></i>{}</span>'
    key += [markup(patch, variable(name), words.PHASE_WORDS[name]) for name in phases]
    alternative = f"Speed over distance of the optimum of {run.scenario.title}: " + ", ".join(
        words.advice_in_words(run.advice)
    )
    return markup(
        '<div class="hero">{text}<div class="name">Speed, km/h</div><div class="plot">'
        '<svg role="img" aria-label="{alternative}" viewBox="0 0 {width} {height}" preserveAspectRatio="none">'
        '{picture}</svg>{axes}</div><div class="key">{key}</div></div>',
        text=text,
        alternative=alternative,
        width=f"{WIDTH:g}",
        height=f"{HEIGHT:g}",
        picture=picture(run, fastest),
        axes=axes(run, fastest),
        key=joined(key),
    )


def picture(run: Trajectory, fastest: Trajectory | None) -> Markup:
    """Return the area under the speed, phase by phase, and the line of the fastest run, as SVG."""
    top = top_kmh(run, fastest)
    line = '<path d="M0 {} H{}" stroke="var(--rj-{})" vector-effect="non-scaling-stroke"/>'
    # not at zero, where the ground is drawn last
    shapes = [markup(line, f"{HEIGHT * (1 - speed / top):.1f}", f"{WIDTH:g}", "grid") for speed in ticks(top)[1:]]
    for phase in run.phases:
        # phases begin and end at nodes, up to rounding
        inside = (run.position_m >= phase.start_m - 1e-9) & (run.position_m <= phase.end_m + 1e-9)
        x, y = scaled(run.position_m[inside], run.speed_ms[inside] / MS_PER_KMH, run.distance_m, top, WIDTH, HEIGHT)
        if len(x) < 2:
            continue
        area = f"M{x[0]:.1f} {HEIGHT:g} " + " ".join(f"L{a:.1f} {b:.1f}" for a, b in zip(x, y, strict=True))
        outline, token = f"{area} L{x[-1]:.1f} {HEIGHT:g} Z", variable(phase.phase)
        shapes.append(markup('<path d="{}" fill="var(--rj-{})" fill-opacity="0.8"/>', outline, token))
    if fastest is not None:
        shapes.append(speed_line(fastest, top, WIDTH, HEIGHT, "var(--rj-ink3)", 1.4, Markup('stroke-dasharray="2 4"')))
    shapes.append(speed_line(run, top, WIDTH, HEIGHT, "var(--rj-accent)", 2.8))
    # half a stroke above the edge, at which the other half would be cut off
    shapes.append(markup(line, f"{HEIGHT - 0.5:g}", f"{WIDTH:g}", "groundline"))
    return joined(shapes)


def top_kmh(run: Trajectory, fastest: Trajectory | None) -> float:
    """Return the speed at the upper edge of the picture [km/h]."""
    return 1.06 * max(run.max_speed_kmh, fastest.max_speed_kmh if fastest else 0.0)


def ticks(end: float) -> list[float]:
    """Return round numbers from zero up to `end`, four to eight of them."""
    step = round_step(end / MOST_TICKS)
    # an end that is a round number itself must not be lost to rounding
    return [step * k for k in range(int(end / step + 1e-9) + 1)]


def axes(run: Trajectory, fastest: Trajectory | None) -> Markup:
    """Return the numbers and the title of the picture's axes."""
    top, length_km = top_kmh(run, fastest), run.distance_m / 1000
    # 36 px lie between the picture and the lower edge of its place: see .plot in START_CSS
    speed_name = '<span class="y" style="top:calc((100% - 36px) * {})">{}</span>'
    place_name = '<span class="x" style="left:{}%">{}</span>'
    return joined(
        (
            *(markup(speed_name, f"{1 - speed / top:.4f}", f"{speed:g}") for speed in ticks(top)),
            *(markup(place_name, f"{100 * place / length_km:.2f}", f"{place:g}") for place in ticks(length_km)),
            Markup('<span class="title">Distance, km</span>'),
        )
    )


def card_html(card: Card) -> Markup:
    """Describe a scenario with energy and time of its run, and with its strategy where that is not the optimum."""
    stops = f", {card.stations} stations on the way" if card.stations else ""
    line, shown, cost = _run_words(card.run)
    return markup(
        '<div class="card"><button type="button" data-ask="scenario" data-name="{name}">{title}</button>'
        "<p>{vehicle}</p>"
        '<svg role="img" aria-label="{shown}" viewBox="0 0 {width} {height}" preserveAspectRatio="none">{line}'
        '<path d="M0 {bottom} H{width}" stroke="var(--rj-line2)" vector-effect="non-scaling-stroke"/></svg>'
        '<p class="for">{use}</p><p>{length}\u00a0km{stops}</p><p>{cost}</p></div>',
        name=card.name,
        title=card.title,
        vehicle=card.vehicle,
        shown=shown,
        width=f"{SMALL_WIDTH:g}",
        height=f"{SMALL_HEIGHT:g}",
        bottom=f"{SMALL_HEIGHT - 0.5:g}",
        line=line,
        use=GOOD_FOR.get(card.name, ""),
        length=words.distance(card.length_m),
        stops=stops,
        cost=cost,
    )


def _run_words(run: Trajectory | None) -> tuple[Markup, str, str]:
    """Return the line of a card's run, its description, and the run's strategy, energy and time."""
    if run is None:
        return SKETCHED_LINE, "Being computed: speed over distance", "computing"
    line = speed_line(run, 1.06 * run.max_speed_kmh, SMALL_WIDTH, SMALL_HEIGHT, "var(--rj-accent)", 1.8)
    name = f"Speed over distance, up to {words.number(run.max_speed_kmh)} km/h"
    strategy = "" if run.strategy == "optimal" else f"{words.strategy(run.strategy)}: "
    asked = comparisons.other_time_of(run) and f" (timetable {words.time(run.scenario.travel_time_s)}\u00a0s)"
    cost = f"{strategy}{words.energy(run.energy_kwh)}\u00a0kWh in {words.time(run.travel_time_s)}\u00a0s{asked}"
    return line, name, cost


def speed_line(
    run: Trajectory, top_kmh: float, width: float, height: float, colour: str, stroke: float, dash: str = ""
) -> Markup:
    """Return the speed of a run as a line of SVG."""
    x, y = scaled(run.position_m, run.speed_ms / MS_PER_KMH, run.distance_m, top_kmh, width, height)
    points = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x, y, strict=True))
    return markup(
        # the picture is stretched to its place, which must not stretch its strokes
        '<polyline points="{}" fill="none" stroke="{}" stroke-width="{}" {} vector-effect="non-scaling-stroke" '
        'stroke-linejoin="round"/>',
        points,
        colour,
        stroke,
        dash,
    )


def scaled(
    position_m: FloatArray, speed_kmh: FloatArray, length_m: float, top_kmh: float, width: float, height: float
) -> tuple[FloatArray, FloatArray]:
    """Return places and speeds in a picture's units, thinned out to what it can show; each stop stays."""
    some = np.linspace(0, len(position_m) - 1, min(len(position_m), MAX_POINTS)).astype(int)
    keep = np.union1d(some, np.flatnonzero(speed_kmh == 0))
    return width * position_m[keep] / length_m, height * (1 - speed_kmh[keep] / top_kmh)
