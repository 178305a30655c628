"""Draws a `Page`: its figures, its message, its fields in the sidebar."""

from collections.abc import Callable, Iterable, Mapping
from functools import partial
from importlib import import_module
from typing import Any

import param
from panel.viewable import Viewable

from railjoule.dashboard.browser.browser import Browser
from railjoule.dashboard.charts.axis import Axis
from railjoule.dashboard.charts.chart import Chart
from railjoule.dashboard.charts.plot import AnyPlot
from railjoule.dashboard.look.glossary import info
from railjoule.dashboard.look.markup import markup
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.page import Hint, Own, Page, PageWorks, Section
from railjoule.dashboard.page_list import page_classes, room_of
from railjoule.dashboard.pages.page import PageView
from railjoule.dashboard.parts.choices import box, menu
from railjoule.dashboard.parts.html import html_pane, stack
from railjoule.dashboard.parts.number_field import NumberField
from railjoule.dashboard.state.numbers import TypedNumber
from railjoule.dashboard.state.workbench import Workbench


class PageHost(PageView):
    """The view of a page that is one class."""

    of: Page

    def __init__(self, page: Page, browser: Browser, palette: Palette) -> None:
        self.of, self.page, self.halves_from_px = page, page.page, page.halves_from_px
        self.rail_px = page.rail_px
        self.heights: Mapping[str, tuple[int, int, int]] = {plot.name: plot.heights for plot in page.figures}
        super().__init__(page.desk, browser, palette)

    def make(self) -> Viewable:
        """Make the parts of the page, and return them laid out."""
        page = self.of
        self.axes: dict[str, Axis] = {}
        self.plots: dict[str, Any] = {
            plot.name: plot.made(self._find_axis(plot), self.palette) for plot in page.figures
        }
        page.host = self
        content = page.layout()
        if "tab" in page.param:
            page.param.watch(self._appear, "tab")
        for name, names in page.methods("shown"):
            sources: dict[int, tuple[param.Parameterized, list[str]]] = {}
            for source, found in map(page.source, names):
                sources.setdefault(id(source), (source, []))[1].extend(found)
            method = getattr(page, name)
            self.shows(method, *sources.values(), is_open=partial(page.is_shown, method.tab))
        return stack(self.heading, self.message, content)

    @property
    def axis(self) -> Axis:
        """The axis that the figures share, where the page has only one."""
        return self.axes[""]

    def _find_axis(self, plot: AnyPlot) -> Axis:
        name = getattr(plot, "axis", "")
        if name not in self.axes:
            self.axes[name] = Axis(self.palette)
        return self.axes[name]

    def draw(self, plots: Iterable[AnyPlot], *drawn: Any, **more: Any) -> None:
        """Draw the same in figures of the page, each as its chart draws; what is out of sight is drawn later."""
        for plot in plots:
            chart = self.plots[plot.name]
            chart.show(partial(chart.draw, *drawn, **more))

    def take_charts(self, charts: Iterable[Chart]) -> None:
        """Have these charts besides those of the page's figures, in place of those taken before."""
        named = {plot.name: self.plots[plot.name] for plot in self.of.figures}
        self.plots = {**named, **{chart.name: chart for chart in charts}}
        self.queue.take(self.charts)
        self._fit()

    @property
    def charts(self) -> tuple[Chart, ...]:
        """All charts of the page."""
        return tuple(self.plots.values())

    def settle(self) -> None:
        """Tell the cursor of the figures that it may meet new ones."""
        for name, axis in self.axes.items():
            axis.settle_over(self.of.is_over_time(name))

    def _fit(self) -> None:
        super()._fit()
        halves, self.halves_from_px = self.halves_from_px, None
        for name in self.of.full_width:
            self.plots[name].width_px = self.room_px()
        self.halves_from_px = halves


def _field(page: Page, spec: str | Section | Hint | Own) -> Viewable:
    if isinstance(spec, Own):
        return spec.make(page)
    if isinstance(spec, Section):
        aside = markup(" <span>\u00b7 {}</span>", spec.aside) if spec.aside else ""
        return html_pane(markup('<div class="section">{}{}</div>', spec.title, aside))
    if isinstance(spec, Hint):
        return html_pane(markup('<div class="row small"><span>{}{}</span></div>', spec.sentence, info(spec.term)))
    declared = page.param[spec]
    if isinstance(declared, TypedNumber):
        return NumberField(page, spec)
    if isinstance(declared, param.Selector):
        return menu(page, spec, declared.label, page.choices.get(spec) or {str(one): one for one in declared.objects})
    return box(page, spec, declared.label, margin=(0, 16, 0, 14))


class PageFields:
    """The fields of a page for the sidebar, below one another."""

    def __init__(self, page: Page) -> None:
        self.view = stack(*(_field(page, spec) for spec in page.fields), html_pane('<hr class="rule">'))


def make_works(name: str) -> Callable[[Workbench], PageWorks]:
    """Return a maker of the work of a page that is one class."""

    def works(state: Workbench) -> PageWorks:
        return PageWorks(state.pages[name])

    works.__name__ = name
    return works


def hosted(kind: type[Page]) -> type[PageView]:
    """Return the view of pages of a class, made as all views are."""

    class Hosted(PageHost):
        """The view of a page of this class."""

        page = kind.page

        def __init__(self, state: Workbench, browser: Browser, palette: Palette) -> None:
            super().__init__(state.pages[kind.page], browser, palette)

    # a page that computes nothing has no work
    own = [make_works(kind.page)] if any(kind.methods("work")) else []
    Hosted.works = (*own, *kind.works)
    Hosted.__name__ = Hosted.__qualname__ = f"{kind.__name__}View"
    return Hosted


def find_view(name: str) -> type[PageView]:
    """Return the view of a page: the one in its room, or that of a page which is one class."""
    kind = page_classes().get(name)
    if kind is not None:
        return hosted(kind)
    module = import_module(f"{room_of(name)}.view")
    # each such module has PageView too, whose name of a page is empty
    made = (found for found in vars(module).values() if isinstance(found, type) and issubclass(found, PageView))
    return next(view for view in made if view.page == name)
