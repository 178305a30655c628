"""Energy as a Sankey diagram: from the supply through the drive to the train, to its losses, and back."""

from collections.abc import Sequence
from dataclasses import dataclass

from railjoule.core import Trajectory
from railjoule.core.energy_along import EnergyFlow, energy_flow
from railjoule.core.units import J_PER_KWH
from railjoule.dashboard.charts.chart import Chart
from railjoule.dashboard.look import words
from railjoule.dashboard.look.markup import Markup, joined, markup
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.look.tokens import FONT, Tokens
from railjoule.dashboard.parts import html as parts

LINE, DRIVE, TRAIN, BRAKE = "Supply", "Powertrain", "Train", "Brake"
BACK = "Recuperated"
KNOTS = (LINE, DRIVE, TRAIN, BRAKE)
"""Intermediate nodes of the energy flow; all other nodes are sources or sinks."""
SMALLEST_SHARE = 1e-4
"""Flows below this share of the energy from the supply are not drawn."""
# TOP_PX has room for the two lines of text above the first knot, see `_knot`
TALL_PX, KNOT_PX, GAP_PX, TOP_PX = 150.0, 9.0, 9.0, 34.0
ROW_PX = 17.0
WIDEST_PX, LEFT_PX, NAMES_PX, FONT_PX = 1100, 50.0, 210.0, 12
KNOT_PLACES = (0.0, 0.27, 0.52, 0.76)
"""Horizontal positions of the nodes, as shares of the distance to the names of the sinks."""
BEND_PX = 9.0


@dataclass(frozen=True)
class Link:
    """Energy that goes from one place to another [J], in the colour of a token."""

    source: str
    target: str
    joules: float
    token: str


def build_links(flow: EnergyFlow) -> tuple[Link, ...]:
    """Return the flows between nodes, from top to bottom; inflow and outflow of each node are equal."""
    energy = flow.energy
    links = [
        Link(LINE, "Auxiliaries", energy.auxiliary_j, "groundline"),
        Link(LINE, DRIVE, energy.traction_j, "accent"),
        Link(DRIVE, "Powertrain losses, driving", flow.driving_loss_j, "brake"),
        Link(DRIVE, TRAIN, flow.wheel_traction_j, "accent"),
        Link("Height lost", TRAIN, -energy.potential_j, "groundline"),
        Link("Speed lost", TRAIN, -energy.kinetic_j, "groundline"),
        Link(TRAIN, "Running resistance", energy.running_resistance_j, "groundline"),
        Link(TRAIN, "Curves", energy.curve_resistance_j, "groundline"),
        Link(TRAIN, "Height gained", energy.potential_j, "groundline"),
        Link(TRAIN, "Speed gained", energy.kinetic_j, "groundline"),
        Link(TRAIN, "Friction brakes", flow.friction_brakes_j, "brake"),
        Link(TRAIN, BRAKE, flow.wheel_braking_j, "accent"),
        Link(BRAKE, "Powertrain losses, braking", flow.braking_loss_j, "brake"),
        Link(BRAKE, "Brake resistors", flow.brake_resistors_j, "brake"),
        Link(BRAKE, BACK, energy.recuperated_j, "accent"),
    ]
    least = SMALLEST_SHARE * max(energy.traction_j + energy.auxiliary_j, 1.0)
    return tuple(link for link in links if link.joules > least)


def kwh(joules: float) -> str:
    """Return an energy [J] in kWh as it stands at a ribbon."""
    return words.energy(joules / J_PER_KWH)


# by hand: HoloViews' diagram refuses circles, and energy comes back to the supply; plotly's needs 4.8 MB of script
class SankeyChart(Chart):
    """The flow of a run's energy, drawn as SVG within the page."""

    kind = "bars"

    def __init__(self, height: int, palette: Palette) -> None:
        super().__init__("sankey", "Energy from the supply to losses and back, kWh", height)
        self.palette = palette

    def build(self) -> None:
        """Make the pane."""
        self.content = self.pane = parts.html_pane()

    def draw(self, run: Trajectory, width_px: float) -> None:
        """Draw a run."""
        self.pane.object = sankey(energy_flow(run), self.palette.tokens, min(width_px, WIDEST_PX), self.caption)


def sankey(flow: EnergyFlow, tokens: Tokens, width_px: float, title: str) -> Markup:
    """Return the diagram as HTML: a caption, an SVG with literal colours, and its numbers in a folded table.

    Parameters
    ----------
    flow : EnergyFlow
        Energies of the run.
    tokens : Tokens
        The colours.
    width_px : float
        How wide it may be [px].
    title : str
        The caption.
    """
    links = build_links(flow)
    svg = Drawing(links, tokens, width_px).svg(title)
    rows = [((link.source, link.target, kwh(link.joules)), False) for link in links]
    table = parts.plain_table(("From", "To", "kWh"), rows, title)
    template = '<div class="caption">{}</div><div class="sankey">{}</div><div class="hidden">{}</div>'
    return markup(template, title, svg, table)


class Drawing:
    """Places and ribbons of one diagram.

    Parameters
    ----------
    links : sequence of Link
        Flows between nodes.
    tokens : Tokens
        The colours.
    width_px : float
        How wide it is [px].
    """

    def __init__(self, links: Sequence[Link], tokens: Tokens, width_px: float) -> None:
        self.links, self.tokens, self.width = links, tokens, width_px
        # where height or speed is lost, more passes the train than the supply gives
        most = max(sum(link.joules for link in links if link.source == LINE), self._through(TRAIN), 1.0)
        self.px_per_j = TALL_PX / most
        self.tops: dict[str, float] = {}
        self.ends = [link for link in links if link.target not in (*KNOTS, BACK)]
        self.sources = [link for link in links if link.source not in KNOTS]
        self._place_knots()
        self._place_ends()

    def _through(self, knot: str) -> float:
        arriving = sum(link.joules for link in self.links if link.target == knot)
        leaving = sum(link.joules for link in self.links if link.source == knot)
        return max(arriving, leaving)

    def _x(self, knot: str) -> float:
        return LEFT_PX + KNOT_PLACES[KNOTS.index(knot)] * (self.end_x - LEFT_PX)

    @property
    def end_x(self) -> float:
        """Horizontal position at which the ribbons end and the names begin [px]."""
        return self.width - NAMES_PX

    def _place_knots(self) -> None:
        """Place each node below the ribbons that leave before it."""
        top = TOP_PX
        for knot in KNOTS:
            self.tops[knot] = top
            leaving = [link for link in self.links if link.source == knot and link.target not in (*KNOTS, BACK)]
            top += self.px_per_j * sum(link.joules for link in leaving) + GAP_PX * len(leaving)

    def _place_ends(self) -> None:
        """Put the ends below each other, each in a row that its name fits."""
        self.end_tops: dict[str, float] = {}
        top = 8.0
        for link in self.ends:
            height = self.px_per_j * link.joules
            room = max(height, ROW_PX)
            self.end_tops[link.target] = top + 0.5 * (room - height)
            top += room + 3.0
        lowest = max(self.tops[knot] + self.px_per_j * self._through(knot) for knot in KNOTS if self._through(knot))
        self.source_tops: dict[str, float] = {}
        place = self.tops[DRIVE] + self.px_per_j * self._through(DRIVE) + 2 * GAP_PX
        for link in self.sources:
            self.source_tops[link.source] = place
            place += max(self.px_per_j * link.joules, ROW_PX) + 3.0
        self.bottom = max(top, lowest, place if self.sources else 0.0)

    def svg(self, title: str) -> str:
        """Return the SVG, with its numbers in words for screen readers."""
        spoken = "; ".join(f"{link.source} to {link.target} {kwh(link.joules)}" for link in self.links)
        drawn = [*self._ribbons(), *(self._knot(knot) for knot in KNOTS if self._through(knot))]
        drawn += [self._end(link) for link in self.ends] + [self._source(link) for link in self.sources]
        height = self.bottom + 6
        back = next((link for link in self.links if link.target == BACK), None)
        if back is not None:
            drawn.append(self._back(back))
            height += self.px_per_j * back.joules + 2 * BEND_PX + 20
        return markup(
            '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}" '
            'role="img" aria-label="{title}: {spoken}" data-figure="{title}" font-family="{font}" font-size="{size}" '
            'fill="{ink}">{drawn}</svg>',
            width=f"{self.width:.0f}",
            height=f"{height:.0f}",
            title=title,
            spoken=spoken,
            font=FONT,
            size=FONT_PX,
            ink=self.tokens["ink2"],
            drawn=joined(drawn),
        )

    def _ribbons(self) -> list[Markup]:
        """Return the ribbons; at a knot they leave and arrive from top to bottom in the order of the links."""
        left = {knot: self.tops[knot] for knot in KNOTS}
        right = dict(left)
        ribbons = []
        for link in self.links:
            height = self.px_per_j * link.joules
            # it leads back below all others, see `_back`
            if link.target == BACK:
                continue
            if link.source in KNOTS:
                x0, y0 = self._x(link.source) + KNOT_PX, right[link.source]
                right[link.source] += height
            else:
                x0, y0 = self._x(DRIVE) + KNOT_PX, self.source_tops[link.source]
            if link.target in KNOTS:
                x1, y1 = self._x(link.target), left[link.target]
                left[link.target] += height
            else:
                x1, y1 = self.end_x, self.end_tops[link.target]
            # less than a pixel, but seen
            ribbons.append(self._ribbon(x0, y0, x1, y1, max(height, 0.8), link.token))
        return ribbons

    def _ribbon(self, x0: float, y0: float, x1: float, y1: float, height: float, token: str) -> Markup:
        middle = 0.5 * (x0 + x1)
        upper = f"M{x0:.1f} {y0:.1f}C{middle:.1f} {y0:.1f} {middle:.1f} {y1:.1f} {x1:.1f} {y1:.1f}"
        lower = (
            f"v{height:.1f}C{middle:.1f} {y1 + height:.1f} {middle:.1f} {y0 + height:.1f} {x0:.1f} {y0 + height:.1f}Z"
        )
        return markup('<path d="{}{}" fill="{}" fill-opacity="0.45"/>', upper, lower, self.tokens[token])

    def _knot(self, knot: str) -> Markup:
        x, y, height = self._x(knot), self.tops[knot], max(self.px_per_j * self._through(knot), 1.0)
        box = f'<rect x="{x:.1f}" y="{y:.1f}" width="{KNOT_PX:g}" height="{height:.1f}" '
        bar = markup('{}fill="{}"/>', Markup(box), self.tokens["ink3"])
        name = self._text(x, y - 17, knot, strong=True)
        return bar + name + self._text(x, y - 4, kwh(self._through(knot)))

    def _end(self, link: Link) -> Markup:
        y = self.end_tops[link.target] + 0.5 * self.px_per_j * link.joules + 4
        return self._text(self.end_x + 6, y, f"{link.target} {kwh(link.joules)}")

    def _source(self, link: Link) -> Markup:
        x, y = self._x(DRIVE), self.source_tops[link.source] + 0.5 * self.px_per_j * link.joules + 4
        return self._text(x + KNOT_PX - 4, y, f"{link.source} {kwh(link.joules)}", anchor="end")

    def _text(self, x: float, y: float, text: str, strong: bool = False, anchor: str = "start") -> Markup:
        weight = Markup(' font-weight="600"') if strong else ""
        template = '<text x="{}" y="{}" text-anchor="{}"{}>{}</text>'
        return markup(template, f"{x:.1f}", f"{y:.1f}", anchor, weight, text)

    def _back(self, link: Link) -> Markup:
        """Return the ribbon that leads back below all others, with its arrow at the supply."""
        thick = max(self.px_per_j * link.joules, 1.5)
        radius = 0.5 * thick + BEND_PX
        given = sum(other.joules for other in self.links if other.source == BRAKE and other is not link)
        y0 = self.tops[BRAKE] + self.px_per_j * given + 0.5 * thick
        y1 = max(self.bottom + 14 + 0.5 * thick, y0 + 2 * radius)
        x0, x1 = self._x(BRAKE) + KNOT_PX, LEFT_PX + 0.5 * KNOT_PX
        tip = self.tops[LINE] + self.px_per_j * self._through(LINE) + 4
        path = (
            f"M{x0:.1f} {y0:.1f}h2a{radius:.1f} {radius:.1f} 0 0 1 {radius:.1f} {radius:.1f}V{y1 - radius:.1f}"
            f"a{radius:.1f} {radius:.1f} 0 0 1 {-radius:.1f} {radius:.1f}H{x1 + radius + 0.5 * thick:.1f}"
            f"a{radius:.1f} {radius:.1f} 0 0 1 {-radius:.1f} {-radius:.1f}V{tip + 8:.1f}"
        )
        arrow_x, half = x1 + 0.5 * thick, 0.5 * thick + 4
        arrow = f"M{arrow_x - half:.1f} {tip + 9:.1f}h{2 * half:.1f}L{arrow_x:.1f} {tip:.1f}Z"
        accent = self.tokens["accent"]
        label = self._text(0.5 * (x0 + x1), y1 - 0.5 * thick - 4, f"{BACK} {kwh(link.joules)}", anchor="middle")
        return markup(
            '<path d="{}" fill="none" stroke="{}" stroke-opacity="0.3" stroke-width="{}"/>'
            '<path d="{}" fill="{}" fill-opacity="0.6"/>{}',
            path,
            accent,
            f"{thick:.1f}",
            arrow,
            accent,
            label,
        )
