"""Start: what this is in one sentence and one picture, and the scenarios to begin with."""

import numpy as np
import panel as pn
import panel_material_ui as pmui
from panel.viewable import Viewable

from railjoule.core import RailjouleError, Trajectory
from railjoule.core.arrays import FloatArray
from railjoule.core.units import MS_PER_KMH
from railjoule.dashboard.charts.surface import round_step
from railjoule.dashboard.insides import Words
from railjoule.dashboard.look import comparisons, words
from railjoule.dashboard.look.markup import Markup, joined, markup
from railjoule.dashboard.look.theme import parts_css
from railjoule.dashboard.look.tokens import variable
from railjoule.dashboard.page_list import PAGES
from railjoule.dashboard.pages.page import PageView
from railjoule.dashboard.pages.start.compute import Card, outlines
from railjoule.dashboard.pages.start.my_files import FILES_CSS, files_html
from railjoule.dashboard.pages.start.work import Start
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.work.runs import Runs

GROUPS: tuple[tuple[str, str, tuple[str, ...]], ...] = (
    (
        "First steps",
        "one run between two stops: move the travel time and see what changes",
        ("metro-with-limit", "tram-950m", "ftorek-300s", "liashenko-ii", "tram-950m-stop", "tram-950m-recuperating"),
    ),
    (
        "Whole lines",
        "several stations: how the optimum shares the time among them",
        ("metro-10-stations",),
    ),
    (
        "From the papers",
        "the cases of published studies, to compare with what they print",
        (
            "liashenko-0",
            "liashenko-i",
            "liashenko-iii",
            "liashenko-fig-3",
            "liashenko-fig-4",
            "liashenko-fig-5",
            "liashenko-fig-6",
            "kharkiv-like-40kmh",
            "kharkiv-like-20kmh",
        ),
    ),
)
"""Title, what they show and names of the scenarios that belong together."""
OTHERS = ("More", "further scenarios")
GOOD_FOR = {
    "metro-with-limit": "Start here: gradients, a speed limit and part of the braking energy recuperated.",
    "tram-950m": "Level track without recuperation: why coasting saves.",
    "ftorek-300s": "All strategies run on it: good for Compare and Trade-off.",
    "liashenko-ii": "Down into a valley and out of it: where to coast and where to drive.",
    "tram-950m-stop": "A red signal on the way: what an unplanned stop costs.",
    "tram-950m-recuperating": "The same tram with recuperation: later coasting, later braking.",
    "metro-10-stations": "Ten stations in one timetable: which leg gets how much running-time supplement.",
    "liashenko-0": "A steady rise of 3 per mille: the plain case beside the three profiles.",
    "liashenko-i": "Light gradients, up to 10 per mille.",
    "liashenko-iii": "Heavy gradients, up to 40 per mille.",
    "liashenko-fig-3": "Planned at half load, driven full and with the position 10\u00a0m wrong.",
    "liashenko-fig-4": "Planned at half load, driven nearly empty and 5\u00a0m wrong, on profile I.",
    "liashenko-fig-5": "Planned at half load, driven full at the right position, on profile II.",
    "liashenko-fig-6": "Planned at half load, driven fuller and 15\u00a0m wrong, on profile III.",
    "kharkiv-like-40kmh": "Limits of sections as set speeds, at 40\u00a0km/h on average.",
    "kharkiv-like-20kmh": "The same line at half the speed: where limits as set speeds cost most.",
}
"""What each shipped scenario is good for, in one line."""
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
MORE = (
    "Choose a scenario, move the travel time and see what the driver has to do, how much more the other "
    "strategies need, and how wrong loads, delays and speed limits change it."
)
START_CSS = """
.hero { padding: 22px 20px 6px; }
.hero h1 { font-size: 25px; line-height: 1.25; max-width: 32em; text-wrap: balance; }
.hero p { font-size: 14px; margin-top: 8px; max-width: 62em; color: var(--rj-ink2); }
.hero svg { display: block; width: 100%; height: 230px; margin-top: 14px; }
.hero .key { display: flex; flex-wrap: wrap; gap: 2px 22px; font-size: 12px; margin-top: 6px; color: var(--rj-ink2); }
.hero .key b { color: var(--rj-accent); font-weight: 600; }
.hero .key i { display: inline-block; width: 10px; height: 10px; margin-right: 5px; border: 1px solid var(--rj-line2); }
h2.begin { padding: 16px 20px 4px; font-size: 15px; }
h2.begin span { margin-left: 8px; font-size: 13px; font-weight: 400; }
.hero .plot { position: relative; margin: 14px 0 0 44px; padding-bottom: 36px; }
.hero .plot svg { margin: 0; }
.hero .plot span { position: absolute; font-size: 11px; line-height: 14px; color: var(--rj-ink3); }
.hero .plot .y { right: calc(100% + 8px); transform: translateY(-50%); }
.hero .plot .x { bottom: 18px; transform: translateX(-50%); }
.hero .plot .title { bottom: 0; left: 50%; transform: translateX(-50%); font-size: 12px; color: var(--rj-ink2); }
.hero .name { margin-top: 14px; font-size: 12px; color: var(--rj-ink2); }
.hero .name + .plot { margin-top: 4px; }
@media (min-width: 1600px) { .hero svg { height: 320px; } }
@media (max-width: 899px) {
  .hero { padding: 14px 14px 4px; } .hero h1 { font-size: 20px; } .hero svg { height: 150px; }
  h2.begin { padding-left: 14px; }
}
"""
CARD_CSS = """
:host { border-top: 1px solid var(--rj-line); padding: 12px 0 10px; }
.card button { display: block; min-height: 24px; padding: 0; border: 0; background: none; text-align: left;
  font: 600 13.5px/1.3 var(--rj-font); color: var(--rj-accent); cursor: pointer; }
.card button:hover { text-decoration: underline; }
.card button:active { color: var(--rj-ink); }
.card button:focus-visible { outline: 2px solid var(--rj-accent); outline-offset: 2px; }
.card p { font-size: 12px; color: var(--rj-ink3); }
.card p.for { color: var(--rj-ink2); min-height: 34px; text-wrap: pretty; }
.card svg { display: block; width: 100%; height: 54px; margin: 8px 0 2px; }
"""
GRID_CSS = """
:host { display: grid; grid-template-columns: repeat(auto-fill, minmax(236px, 1fr)); gap: 0 24px;
  padding: 4px 20px 24px; align-items: stretch; }
@media (max-width: 899px) { :host { padding: 4px 14px 24px; } }
"""


def groups(names: tuple[str, ...]) -> list[tuple[str, str, tuple[str, ...]]]:
    """Return title, what it shows and scenarios of each group; what no group names stands last."""
    named = [name for _, _, members in GROUPS for name in members]
    rest = tuple(name for name in names if name not in named)
    listed = [(title, shows, tuple(name for name in members if name in names)) for title, shows, members in GROUPS]
    return [*listed, *([(*OTHERS, rest)] if rest else [])]


class StartView(PageView):
    """The page on which a new session begins."""

    page = "Start"
    works = (Start,)

    def make(self) -> Viewable:
        """Make the pieces of the page, and return them laid out."""
        self.hero = parts.html_pane(hero(None), stylesheets=[parts_css(), START_CSS])
        self.cards = {card.name: self._card_pane(card) for card in outlines()}
        self._shown: dict[str, Card] = {}
        self.browser.on_open(self._open)
        self.browser.on_file(self._open_file)
        files = self.state.files
        self.files = parts.html_pane(stylesheets=[parts_css(), START_CSS, FILES_CSS], visible=files.folder is not None)
        self.bring = pmui.Button(
            label="Bring your own line",
            icon="upload_file",
            variant="outlined",
            size="small",
            margin=(10, 20, 2, 20),
            on_click=lambda _: setattr(self.state, "page", "Files"),
        )
        self.shows(self._show_files, (files, ["listing", "refusal", "current"]))
        self.shows(self._show_picture, (self.state, ["runs"]))
        self.shows(self._show_cards, (self.state.start, ["cards"]))
        cards = (piece for group in groups(tuple(self.cards)) for piece in self._laid_out(*group))
        return parts.stack(self.hero, self.bring, self.files, *cards)

    def _laid_out(self, title: str, shows: str, names: tuple[str, ...]) -> tuple[Viewable, Viewable]:
        """Return the heading of a group of cards, and its cards."""
        heading = markup('<h2 class="begin">{} <span class="muted">{}</span></h2>', title, shows)
        cards = parts.stack(*(self.cards[name] for name in names), css=GRID_CSS)
        return parts.html_pane(heading, stylesheets=[parts_css(), START_CSS]), cards

    def _card_pane(self, card: Card) -> Words:
        return parts.html_pane(card_html(card), stylesheets=[parts_css(), CARD_CSS])

    def _show_picture(self) -> None:
        if self.state.runs is not None:
            self.hero.object = hero(self.state.runs)

    def _show_cards(self) -> None:
        for card in self.state.start.cards:
            # one that is still to be computed may be shown with its fastest run meanwhile
            if card.run is not None and self._shown.get(card.name) is not card:
                self._shown[card.name] = card
                self.cards[card.name].object = card_html(card)

    def _show_files(self) -> None:
        if self.state.files.folder is not None:
            self.files.object = files_html(self.state.files)

    def _open_file(self, name: str) -> None:
        """Open a file of the folder on Drive."""

        def turn() -> None:
            self.state.param.update(page="Drive", notice="")

        def refuse(error: RailjouleError) -> None:
            self.state.notice = str(error)
            self.state.files.look()

        self.state.files.open(name, turn, refuse)

    def _open(self, name: str) -> None:
        if name not in self.cards:
            return
        with pn.io.hold():
            # before the page is turned: what Drive asks for first is of this scenario
            self.state.scenario.choose(name)
            self.state.page = "Drive"


def hero(runs: Runs | None) -> Markup:
    """Return the sentence, and the picture of the present optimum beside the fastest run once it is there."""
    text = markup("<h1>{}</h1><p>{} {}</p>", PAGES["Start"].question, LEAD, MORE)
    if runs is None:
        return markup(
            '<div class="hero">{}<svg role="img" aria-label="Being computed: the first run" viewBox="0 0 10 10" '
            'preserveAspectRatio="none">{}</svg><div class="key">Computing</div></div>',
            text,
            HERO_SKETCH,
        )
    run, fastest = runs.best, runs.runs.get("fastest")
    phases = dict.fromkeys(phase.phase for phase in run.phases)
    told = (words.energy(run.energy_kwh), words.time(run.travel_time_s))
    key = [
        markup("<span><b>{}</b>, {} km</span>", run.scenario.title, words.distance(run.distance_m)),
        markup("<span>{}: <b>{} kWh</b> in {} s</span>", words.strategy(run.strategy), *told),
    ]
    if fastest is not None:
        told = (words.energy(fastest.energy_kwh), words.time(fastest.travel_time_s))
        key.append(markup("<span>dotted: fastest possible, {} kWh in {} s</span>", *told))
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
    """Return what a scenario is, and energy and time of its run with its strategy where that is not the optimum."""
    stops = f", {card.stations} stations on the way" if card.stations else ""
    line, shown, cost = _run_words(card.run)
    return markup(
        # by data-scenario, the browser's half turns to Drive before the server answers
        '<div class="card"><button type="button" data-scenario="{name}">{title}</button><p>{vehicle}</p>'
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
    """Return the line of a card's run, what it shows, and the run's strategy, energy and time."""
    if run is None:
        return SKETCHED_LINE, "Being computed: speed over distance", "computing"
    line = speed_line(run, 1.06 * run.max_speed_kmh, SMALL_WIDTH, SMALL_HEIGHT, "var(--rj-accent)", 1.8)
    name = f"Speed over distance, up to {words.number(run.max_speed_kmh)} km/h"
    strategy = "" if run.strategy == "optimal" else f"{words.strategy(run.strategy)}: "
    asked = comparisons.other_time_of(run) and f" ({words.time(run.scenario.travel_time_s)}\u00a0s allowed)"
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
