"""What a storage on board would save of the energy that braking gives."""

from railjoule.core.energy import share_above
from railjoule.dashboard.charts.chart import nice_range, points, xy
from railjoule.dashboard.charts.figures import LoneChart
from railjoule.dashboard.look import words
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.pages.speed_limits.compute import StorageCurve
from railjoule.dashboard.parts import html as parts


class StorageChart(LoneChart):
    """What storages of one power save against resistors."""

    def __init__(self, height: int, palette: Palette) -> None:
        caption = "Saved by storage instead of brake resistors, kWh, over storage size, kWh"
        super().__init__("storage", caption, height, palette)

    def build(self) -> None:
        """Make the figure."""
        self.frame(ticks=4, digits=1, x_title="Size, kWh")
        self.source("most", "x", "y", "text")
        self.source("need", "x", "y", "text")
        self.glyphs("hspan", "most", "y", paint={"line_color": "good"}, line_width=1.2, line_dash=[4, 3])
        self.hairlines("need", "line2")
        self.line("curve", "accent", line_width=2.2)
        self.dots("chosen", size=11, line_width=2)
        self.signs("most", "good", y_offset=-4, x_offset=6)
        self.signs("need", "ink2", x_offset=-6, y_offset=-6, text_align="right")

    def draw(self, storage: StorageCurve) -> None:
        """Draw the curve, the size needed, the storage chosen and what a receptive line would save."""
        chosen, need = storage.chosen, storage.need.max_drop_kwh
        most = chosen.with_resistors_kwh - chosen.with_receptive_line_kwh
        self.put("curve", **xy(storage.size_kwh, storage.saved_kwh))
        self.put("chosen", **points([(chosen.storage.size_kwh, chosen.saved_kwh)]))
        self.put("most", x=[0.0], y=[most], text=[f"fully receptive supply: {words.energy(most)} kWh"])
        self.put("need", x=[need], y=[0.0], text=[f"needed: {words.energy(need)} kWh"])
        # a run that never brakes has nothing to save: the axis must still have a height
        _, high = nice_range(0.0, max(most, 1e-3), 0.2)
        self.set_ranges((0.0, float(storage.size_kwh[-1])), (0.0, high))


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
