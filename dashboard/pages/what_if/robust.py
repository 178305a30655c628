"""The robust plan beside the nominal one: their speeds, all candidates, and how often both are on time."""

import numpy as np

from railjoule.core.studies.robust_plan import Candidate, DrawnRuns, RobustPlan
from railjoule.dashboard.charts.chart import Axis, nice_range, xy
from railjoule.dashboard.charts.figures import LoneChart
from railjoule.dashboard.charts.line_names import Name
from railjoule.dashboard.charts.plot import ChartOverAxis, Plot
from railjoule.dashboard.charts.quantities import SPEED
from railjoule.dashboard.charts.run_lines import Form, Line, RunLines, ends_of
from railjoule.dashboard.look import words
from railjoule.dashboard.look.key_names import without_keys
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.pages.what_if.compute import RobustAnswer
from railjoule.dashboard.parts import html as parts

LINES = {
    "nominal": Line("accent", {"line_width": 2.2}),
    "robust": Line("good", {"line_width": 1.9, "line_dash": [9, 3]}),
}
HEADROOM = 1.22


class RobustSpeedChart(RunLines):
    """Planned speeds of the nominal and of the robust plan."""

    def __init__(self, height: int, axis: Axis, palette: Palette) -> None:
        caption = "Robust plan: speed, km/h, beside the nominal plan"
        super().__init__("robust_speed", SPEED, LINES, height, axis, palette, caption, Form(ticks=5, last=True))

    def above(self) -> None:
        """Write the names of the lines."""
        self.add_names()

    def draw(self, found: RobustPlan) -> None:
        """Draw the nominal plan, and the robust one once it is known."""
        runs = {"nominal": found.nominal.plan}
        if found.chosen is not None and found.chosen is not found.nominal:
            runs["robust"] = found.chosen.plan
        self.axis.fit(max(float(run.position_m[-1]) for run in runs.values()), roomy=False)
        lines = self.fill(runs)
        self.set_range(0, HEADROOM * ends_of(lines.values())[1])
        tokens = self.palette.tokens
        places = {"nominal": 0.25, "robust": 0.7}
        names = [Name(name, name, tokens[LINES[name].token], preferred=places[name]) for name in runs]
        self.place_names(lines, names)


class CandidatesChart(LoneChart):
    """Expected energy of each candidate over its share of runs on time."""

    kind = "map"

    def __init__(self, height: int, palette: Palette) -> None:
        caption = "Candidates: expected energy, kWh, over runs on time, with the 95 % interval"
        super().__init__("candidates", caption, height, palette)

    def build(self) -> None:
        """Make the figure."""
        self.frame(ticks=4, digits=2, x_title="Runs on time, %")
        self.hairlines("asked", "ink3", line_dash=[2, 3])
        self.glyphs("segment", "intervals", "x", "y", "x1", "y", paint={"line_color": "line2"})
        self.dots("points", "driven", size=6)
        for name, line in LINES.items():
            self.dots(name, line.token, size=9)
        self.add_names()

    def draw(self, found: RobustPlan) -> None:
        """Draw the candidates so far, the probability that was asked for, the nominal and the robust plan."""
        drawn = [one.drawn for one in found.candidates]
        energy = np.array([one.expected_kwh for one in drawn])
        share = 100 * np.array([one.share_on_time for one in drawn])
        intervals = 100 * np.array([one.share_interval for one in drawn])
        self.put("intervals", x=intervals[:, 0].tolist(), y=energy.tolist(), x1=intervals[:, 1].tolist())
        self.put("points", **xy(share, energy))
        self.put("asked", x=[100 * found.probability])
        least, most = nice_range(float(np.nanmin(energy)), float(np.nanmax(energy)), 0.12)
        self.set_ranges((float(min(intervals.min(), 100 * found.probability)) - 2.0, 102.0), (least, most))
        marks = {"nominal": found.nominal, "robust": found.chosen}
        tokens, names, lines = self.palette.tokens, [], {}
        for name, one in marks.items():
            at = [] if one is None else [(100 * one.drawn.share_on_time, one.drawn.expected_kwh)]
            self.put(name, x=[x for x, _ in at], y=[y for _, y in at])
            if at:
                names.append(Name(name, name, tokens[LINES[name].token], point=at[0]))
                lines[name] = (np.array([at[0][0]]), np.array([at[0][1]]))
        self.place_names(lines, names)


ROBUST = (
    ChartOverAxis("robust_speed", RobustSpeedChart, (250, 310, 220), "robust"),
    Plot("candidates", "", heights=(250, 310, 220), chart=CandidatesChart),
)


def robust_text(answer: RobustAnswer) -> str:
    """Return the nominal and the robust plan as a table with the result of the check, or how far the search is."""
    found = answer.found
    if answer.refusal:
        return parts.inset(parts.refusal(without_keys(answer.refusal)))
    if found.chosen is None or found.checked is None:
        tried = len(found.candidates) - 1 + found.refused
        return parts.inset(parts.note_paragraphs([f"{tried} of {found.asked} candidate plans followed."]))
    header = (
        "Plan",
        "Load, %",
        "Resistance",
        "Reserve, s",
        "Planned, kWh",
        "Expected, kWh",
        "On time, %",
        "Interval, %",
    )
    pairs = zip((found.nominal, found.chosen), found.checked, strict=True)
    rows = [(_cells(name, *pair), name == "robust") for name, pair in zip(LINES, pairs, strict=True)]
    return parts.inset(parts.table("Robust plan", header, rows), parts.note_paragraphs(robust_notes(found)))


def _cells(name: str, plan: Candidate, checked: DrawnRuns) -> tuple[str, ...]:
    low, high = checked.share_interval
    return (
        name,
        words.setting(plan.load_factor),
        words.number(plan.resistance_factor, 3),
        words.number(plan.reserve_s, 1),
        words.energy(plan.plan.energy_kwh),
        words.energy(checked.expected_kwh),
        words.share(checked.share_on_time),
        f"{words.share(low)} to {words.share(high)}",
    )


def robust_notes(found: RobustPlan) -> list[str]:
    """Return the cost of the robust plan, the result of its check, and the size of the search, in sentences."""
    assert found.chosen is not None
    assert found.checked is not None
    extra, error = found.extra_kwh
    accepted = found.scenario.disturbance.accepted_delay_s
    late = f" or at most {words.number(accepted, 1)} s late" if accepted else ""
    asked, runs = words.share(found.probability), words.number(found.checked[1].runs, 0)
    held = "enough" if found.is_held else "not enough; choose a higher probability or more candidates"
    cost = f"{words.energy_difference(extra)} \u00b1 {words.number(error, 4)} kWh"
    sentences = [
        f"The robust plan needs {cost} against the nominal plan." if found.chosen is not found.nominal else "",
        f"Asked for: on time{late} in at least {asked} % of the runs. Under {runs} draws that are not the search's, "
        f"the robust plan is on time in {words.share(found.checked[1].share_on_time)} %: {held}.",
        f"Search: {len(found.candidates)} plans under the same {words.number(found.nominal.drawn.runs, 0)} draws. On "
        "time are those whose 95 % interval lies above the probability.",
        f"No train can keep {found.refused} more candidates." if found.refused else "",
    ]
    return [sentence for sentence in sentences if sentence]
