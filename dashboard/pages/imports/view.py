"""Import: files of a line or a train, what they hold, and the scenario that is made of them."""

from collections.abc import Iterator, Mapping
from typing import Any

from panel.viewable import Viewable

from railjoule.core.scenario._sentences import counted
from railjoule.dashboard.charts.chart import Axis, Chart
from railjoule.dashboard.editor.fields_of import Field, parts_of, plain
from railjoule.dashboard.look import words
from railjoule.dashboard.look.key_names import words_of
from railjoule.dashboard.look.markup import Markup, joined, markup
from railjoule.dashboard.pages.imports.charts import ImportedCurves, ImportedHeight, ImportedLimits, gaps_of
from railjoule.dashboard.pages.imports.compute import Reading
from railjoule.dashboard.pages.imports.forms import FilesForm, TakeForm
from railjoule.dashboard.pages.imports.work import Imports
from railjoule.dashboard.pages.page import PageView
from railjoule.dashboard.parts import html as parts

HEIGHTS = {"import_height": (150, 170, 130), "import_limits": (130, 150, 120), "import_curves": (120, 130, 120)}
"""Of each chart [px]: in usual, wide and narrow windows."""
COLUMNS_CSS = """
:host { display: grid; grid-template-columns: minmax(0, 1fr); align-items: start; }
@media (min-width: 1100px) { :host { grid-template-columns: minmax(0, 1fr) minmax(0, 1fr); } }
"""
RIGHT_CSS = """
:host { padding: 4px 20px 20px; }
@media (max-width: 899px) { :host { padding: 4px 14px 16px; } }
"""
EMPTY = "What the files give is drawn here, before anything of the scenario changes."
TOLD = '<div class="block"><h2>{}</h2><ul class="differences">{}</ul></div>'


class ImportView(PageView):
    """The page of what a user brings."""

    page = "Import"
    works = (Imports,)
    heights = HEIGHTS
    halves_from_px = 1100

    def make(self) -> Viewable:
        """Make the pieces of the page, and return them laid out."""
        state, palette = self.state, self.palette
        self.model = state.imports
        self.files = FilesForm(self.model)
        self.take = TakeForm(self.model, lambda: state.scenario.edited)
        self.axis = Axis(palette)
        self.height = ImportedHeight(HEIGHTS["import_height"][0], self.axis, palette)
        self.limits = ImportedLimits(HEIGHTS["import_limits"][0], self.axis, palette)
        self.curves = ImportedCurves(HEIGHTS["import_curves"][0], self.axis, palette)
        self.title, self.told, self.train = (parts.html_pane() for _ in range(3))
        self.drawn = parts.stack(*(chart.host for chart in self.charts), visible=False)
        right = parts.stack(self.title, self.take, self.drawn, self.told, self.train, css=RIGHT_CSS)
        self.shows(self.files.show, (self.model, ["files", "reading", "refusal"]))
        base = (state.scenario, ["preset", "opened", "edits"])
        self.shows(self.take.show, (self.model, ["reading", "stretch"]), base)
        self.shows(self._show, (self.model, ["reading", "failure"]))
        self.shows(self._name, base)
        return parts.stack(self.heading, self.message, parts.stack(self.files, right, css=COLUMNS_CSS))

    @property
    def charts(self) -> tuple[Chart, ...]:
        """All charts of the page."""
        return self.height, self.limits, self.curves

    def settle(self) -> None:
        """Tell the cursor that it may meet new charts."""
        self.axis.settle("m", 0)

    def _name(self) -> None:
        self.heading.object = parts.heading(self.page, self.state.scenario.edited.title, "", "")

    def _show(self) -> None:
        reading: Reading = self.model.reading
        self.tell(self.model.failure, "")
        self.title.object = markup('<div class="block"><h2>{}</h2></div>', title_of(reading))
        self.told.object = told_of(reading)
        self.train.object = train_table(reading)
        line = reading.line
        self.drawn.visible = line is not None
        if line is None:
            return
        run = line.line.in_running_order()
        self.axis.fit(run.length_m, roomy=False)
        self.height.show(lambda: self.height.draw(run, gaps_of(reading, "gradients")))
        self.limits.show(lambda: self.limits.draw(run, gaps_of(reading, "limits")))
        self.curves.show(lambda: self.curves.draw(line))


def title_of(reading: Reading) -> str:
    """Return what there is, in one line."""
    told = []
    if reading.line is not None:
        line = reading.line.line
        told.append(
            f"{line.name or 'Line'}: {words.distance(line.length_m)} km, {counted(len(line.sections), 'section')}"
        )
    if reading.vehicle is not None:
        vehicle = reading.vehicle.vehicle
        told.append(f"{vehicle.name or 'Train'}: {words.number(vehicle.total_mass_kg / 1000, 0)} t")
    return "; ".join(told) or EMPTY


def told_of(reading: Reading) -> Markup:
    """Return what is to be said of all files together."""
    lists = (("Noticed of the line", reading.findings), ("Not used of the line", reading.unused))
    return joined(
        markup(TOLD, title, joined(markup("<li>{}</li>", one) for one in sentences))
        for title, sentences in lists
        if sentences
    )


def train_table(reading: Reading) -> Markup:
    """Return the vehicle that was read as a table."""
    if reading.vehicle is None:
        return Markup("")
    rows = list(vehicle_rows(reading.vehicle.document["vehicle"]))
    return parts.table("Train", ("Quantity", "Value"), [(row, False) for row in rows], "train")


def vehicle_rows(document: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Yield what a vehicle's table says, in words and with units."""
    model = str(document.get("drive", {}).get("model", ""))
    inner = ((f"vehicle.{key}", value) for key, value in document.items() if isinstance(value, dict))
    for table, values in (("vehicle", document), *inner):
        fields = {part.name: part for part in parts_of(table, model) if isinstance(part, Field)}
        group = "" if table == "vehicle" else f"{words_of(table)}: "
        for key, value in values.items():
            if isinstance(value, dict):
                continue
            label = fields[key].label if key in fields else words_of(key)
            yield f"{group}{label}", _shown(value)


def _shown(value: Any) -> str:
    if isinstance(value, list):
        return f"{len(value)} points"
    return plain(value) if isinstance(value, int | float) and not isinstance(value, bool) else str(value)
