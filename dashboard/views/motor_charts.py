"""What the drive makes of the run: efficiency over torque and speed, and what a storage on board would save."""

import numpy as np
from bokeh.models import ColumnDataSource, ContourRenderer, LinearColorMapper, Range1d
from bokeh.plotting.contour import contour_data

from railjoule.core.arrays import FloatArray
from railjoule.core.energy import share_above
from railjoule.core.studies.motor_map import MotorMap, OperatingPoints
from railjoule.dashboard.look import words
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.store import StorageCurve
from railjoule.dashboard.views import parts
from railjoule.dashboard.views.charts import Chart, add_zero, clear, nice_range, text_style, xy
from railjoule.dashboard.views.figures import captioned, empty_figure, ink_on
from railjoule.dashboard.views.surface import CIVIDIS

POOR = 0.8
"""Efficiencies below this share the darkest colour."""
LEVELS = (0.8, 0.85, 0.9, 0.92, 0.94, 0.95, 0.96, 0.97, 0.98)
LABEL_PLACE = 0.6
"""Share of the speeds at which levels bear their numbers."""
NEAR_NM_SHARE = 0.06


class MotorMapChart(Chart):
    """Efficiency over speed and torque of one motor, with the run's cells as points."""

    kind = "map"

    def __init__(self, height: int, palette: Palette, name: str = "motor_map") -> None:
        super().__init__(name, "Efficiency, %, over torque and speed of one motor; points: the run", height)
        self.palette, self.x_range, self.y_range = palette, Range1d(0, 1), Range1d(0, 1)
        self._drawn: FloatArray | None = None

    def build(self) -> None:
        """Make the figure."""
        f = empty_figure(self.height, self.x_range, self.y_range, self.words, self.palette, ticks=5)
        self.figure = f
        f.ygrid.visible = False
        f.xaxis.axis_label, f.yaxis.axis_label = "Speed, rad/s", "Torque, N m"
        self.map = ColumnDataSource({key: [] for key in ("image", "x", "y", "dw", "dh")})
        self.mapper = LinearColorMapper(palette=list(CIVIDIS), low=POOR, high=1, nan_color="rgba(0, 0, 0, 0)")
        f.image("image", "x", "y", "dw", "dh", source=self.map, color_mapper=self.mapper, level="underlay")
        self.levels: ContourRenderer | None = None
        add_zero(f, self.palette)
        self.points = ColumnDataSource({"x": [], "y": []})
        points = f.scatter("x", "y", source=self.points, size=6, line_width=1)
        self.palette.paint(points.glyph, fill_color="speed_limits", line_color="surface")
        self.signs = ColumnDataSource({"x": [], "y": [], "text": [], "colour": []})
        f.text(
            "x",
            "y",
            "text",
            text_color="colour",
            source=self.signs,
            text_align="center",
            text_baseline="middle",
            **text_style(11),
        )
        self.content = captioned(self.words, f)

    def draw(self, found: MotorMap, whose: str, points: OperatingPoints | None) -> None:
        """Draw the map of motor or drive, and where the run works."""
        efficiency = found.motor if whose == "motor" and found.motor is not None else found.drive
        if efficiency is not self._drawn:
            self._drawn = efficiency
            self._draw_map(found, efficiency)
        if points is None:
            clear(self.points)
        else:
            self.points.data = xy(points.speed_rads, points.torque_nm)

    def _draw_map(self, found: MotorMap, efficiency: FloatArray) -> None:
        f = self.figure
        assert f is not None
        speed, torque = found.speed_rads, found.torque_nm
        best = float(np.nanmax(efficiency))
        self.mapper.high = best
        step_x, step_y = speed[1] - speed[0], torque[1] - torque[0]
        # a pixel stands around the place for which it was computed
        self.map.data = {
            "image": [efficiency.astype(np.float32)],
            "x": [float(speed[0] - 0.5 * step_x)],
            "y": [float(torque[0] - 0.5 * step_y)],
            "dw": [float(speed[-1] - speed[0] + step_x)],
            "dh": [float(torque[-1] - torque[0] + step_y)],
        }
        self.x_range.update(start=float(speed[0]), end=float(speed[-1]))
        self.y_range.update(start=float(torque[0]), end=float(torque[-1]))
        if self.levels is None:
            self.levels = f.contour(speed, torque, efficiency, list(LEVELS), line_color="#FFFFFF", line_alpha=0.5)
        else:
            self.levels.set_data(contour_data(speed, torque, efficiency, list(LEVELS), want_fill=False))
        self._sign_levels(found, efficiency, best)

    def _sign_levels(self, found: MotorMap, efficiency: FloatArray, best: float) -> None:
        """Write each level where its line crosses one speed, with room between them."""
        column = int(LABEL_PLACE * (len(found.speed_rads) - 1))
        along, torque = efficiency[:, column], found.torque_nm
        taken: list[float] = []
        signs: dict[str, list[object]] = {"x": [], "y": [], "text": [], "colour": []}
        for level in reversed(LEVELS):
            for k in np.flatnonzero(np.diff(np.sign(along - level)) != 0):
                if not np.isfinite(along[k : k + 2]).all():
                    continue
                place = float(torque[k])
                if any(abs(place - other) < NEAR_NM_SHARE * np.ptp(torque) for other in taken):
                    continue
                taken.append(place)
                share = np.clip((level - POOR) / max(best - POOR, 1e-9), 0, 1)
                signs["x"].append(float(found.speed_rads[column]))
                signs["y"].append(place)
                signs["text"].append(words.number(100 * level, 0))
                signs["colour"].append(ink_on(CIVIDIS[round(share * (len(CIVIDIS) - 1))]))
        self.signs.data = signs


class StorageChart(Chart):
    """What storages of one power save against resistors."""

    def __init__(self, height: int, palette: Palette) -> None:
        super().__init__("storage", "Saved by storage instead of brake resistors, kWh, over storage size, kWh", height)
        self.palette, self.x_range, self.y_range = palette, Range1d(0, 1), Range1d(0, 1)

    def build(self) -> None:
        """Make the figure."""
        f = empty_figure(self.height, self.x_range, self.y_range, self.words, self.palette, ticks=4, digits=1)
        self.figure = f
        f.xaxis.axis_label = "Size, kWh"
        self.curve, self.chosen = (ColumnDataSource({"x": [], "y": []}) for _ in range(2))
        self.most, self.need = (
            ColumnDataSource({"y": [], "x": [], "text": []}),
            ColumnDataSource({"x": [], "y": [], "text": []}),
        )
        most = f.hspan("y", source=self.most, line_width=1.2, line_dash=[4, 3])
        need = f.vspan("x", source=self.need, line_width=1)
        self.palette.paint(most.glyph, line_color="good")
        self.palette.paint(need.glyph, line_color="line2")
        curve = f.line("x", "y", source=self.curve, line_width=2.2)
        self.palette.paint(curve.glyph, line_color="accent")
        point = f.scatter("x", "y", source=self.chosen, size=11, line_width=2)
        self.palette.paint(point.glyph, fill_color="accent", line_color="surface")
        sign = f.text("x", "y", "text", source=self.most, y_offset=-4, x_offset=6, **text_style(11))
        self.palette.paint(sign.glyph, text_color="good")
        sign = f.text(
            "x", "y", "text", source=self.need, x_offset=-6, y_offset=-6, text_align="right", **text_style(11)
        )
        self.palette.paint(sign.glyph, text_color="ink2")
        self.content = captioned(self.words, f)

    def draw(self, storage: StorageCurve) -> None:
        """Draw the curve, the size needed, the storage chosen and what a receptive line would save."""
        chosen, need = storage.chosen, storage.need.largest_drop_kwh
        most = chosen.with_resistors_kwh - chosen.with_receptive_line_kwh
        self.curve.data = xy(storage.size_kwh, storage.saved_kwh)
        self.chosen.data = {"x": [chosen.storage.size_kwh], "y": [chosen.saved_kwh]}
        self.most.data = {"x": [0.0], "y": [most], "text": [f"fully receptive supply: {words.energy(most)} kWh"]}
        self.need.data = {"x": [need], "y": [0.0], "text": [f"needed: {words.energy(need)} kWh"]}
        self.x_range.update(start=0, end=float(storage.size_kwh[-1]))
        _, high = nice_range(0.0, max(most, 1e-3), 0.2)
        self.y_range.update(start=0, end=high)


def storage_table(storage: StorageCurve) -> str:
    """Return energies with resistors, with the chosen storage and with a receptive line."""
    chosen, need = storage.chosen, storage.need
    size = words.energy(chosen.storage.size_kwh)

    def row(name: str, energy: float, strong: bool = False) -> tuple[tuple[str, ...], bool]:
        saved = chosen.with_resistors_kwh - energy
        share = -share_above(energy, chosen.with_resistors_kwh)
        return (name, words.energy(energy), words.energy(saved), words.share(share)), strong

    rows = [
        row("Resistors", chosen.with_resistors_kwh),
        row(f"Storage, {size} kWh, {words.number(chosen.storage.power_kw, 0)} kW", chosen.energy_kwh, True),
        row("Fully receptive supply", chosen.with_receptive_line_kwh),
    ]
    note = (
        f"Braking generates {words.energy(need.generated_kwh)} kWh at up to {words.number(need.charging_peak_kw, 0)} "
        f"kW; driving takes up to {words.number(need.discharging_peak_kw, 0)} kW. The storage loses "
        f"{words.energy(chosen.storage_loss_kwh)} kWh, resistors dissipate {words.energy(chosen.dissipated_kwh)} kWh; "
        f"{words.number(need.cycles_per_day, 0)} full cycles of the size needed in an 18-hour day."
    )
    table = parts.table("Recovered braking energy, kWh", ("Absorbed by", "from the supply", "saved", "%"), rows)
    return parts.inset(table, parts.note_paragraphs([note]))
