"""The page Files: lines, trains and recorded runs from files, what their columns mean, and what can be made of them."""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import cache
from importlib.resources import files as resources
from itertools import count
from pathlib import PurePath
from typing import Any

import panel as pn
import panel_material_ui as pmui
import param
from panel.viewable import Viewable

from railjoule.core import RailjouleError
from railjoule.core.imports import SourceFile
from railjoule.dashboard.keep.dropped import NO_TEXT, REPORTS, SCENARIOS, refused_file, scenario_text, words_of
from railjoule.dashboard.library_workarounds import SmallFile
from railjoule.dashboard.limits import FILE_SUFFIXES, LARGEST_RUN_BYTES, STUDIES, too_large
from railjoule.dashboard.look.markup import Markup
from railjoule.dashboard.look.theme import padded, parts_css
from railjoule.dashboard.page import shows
from railjoule.dashboard.pages.files import texts
from railjoule.dashboard.pages.files.brought import Brought, split_workbook
from railjoule.dashboard.pages.files.line_charts import LINE_PLOTS
from railjoule.dashboard.pages.files.line_tab import LINE
from railjoule.dashboard.pages.files.run_charts import RUN_PLOTS
from railjoule.dashboard.pages.files.runs_tab import RUNS, RunsTab
from railjoule.dashboard.pages.files.sheet_form import SheetForm
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.parts.tabs import PageTabs
from railjoule.dashboard.state.kept import result
from railjoule.dashboard.state.recipes import PageRun
from railjoule.dashboard.workbench import Workbench

TABS: Mapping[str, str] = {LINE: "Line and train", RUNS: "Recorded runs"}
"""The tabs by their names in the address."""
EXAMPLE_SCENARIO = "metro-with-limit"
"""Scenario with the line of the example runs, see tests/measured_example.py."""
EXAMPLE_RUNS = ("recordings/metro-0714.csv", "recordings/metro-1742.csv")
"""Two drivers' runs over one line: the folder has those of other lines too."""
EXAMPLE_LINE = tuple(f"imports/example-{name}.csv" for name in ("limits", "gradients", "curves"))
INVITATION_CSS = (
    padded("0 20px 24px", "0 14px 20px")
    + """
.finding { padding: 0 0 6px; } .block { max-width: 860px; }
table { font-size: 13px; } td, th { text-align: left; white-space: normal; padding: 6px 0 6px 20px; }
"""
)
MAX_FILES = 12
"""Maximum number of files of one page: each is held in the server's memory."""
LONGEST_NAME = 80
"""Characters of a file's name: it comes from the browser, however long."""


@cache
def sources(paths: tuple[str, ...]) -> tuple[SourceFile, ...]:
    """Return shipped files, which never change."""
    assets = resources("railjoule.assets")
    return tuple(SourceFile(PurePath(path).name, (assets / path).read_bytes()) for path in paths)


class Files(RunsTab):
    """The page with its two tabs."""

    page = "Files"
    kept = ("tab", "example", "answers", "begins_at_m", "shown", "coasting_only")
    passing = ("refusal", "begin", "end", "reverse", "line_name")
    figures = (*LINE_PLOTS, *RUN_PLOTS)
    # as the grid of the tab of lines
    halves_from_px = 1100
    full_width = tuple(plot.name for plot in RUN_PLOTS)

    tab = param.Selector(default=LINE, objects=list(TABS), doc="The tab in sight.")
    dropped = result(tuple, "Name and content of a file that was dropped on another page.")
    example = param.Boolean(default=False, doc="Whether the example runs are among the files.")

    def __init__(self, desk: Workbench, **params: Any) -> None:
        super().__init__(desk, **params)
        self._count, self._newest = 0, (0, "")
        self.param.watch(self._bring_dropped, "dropped")
        self.param.watch(self._bring_example, "example")
        self.param.watch(self._turn_to_newest, "reading")
        self.param.watch(self.open_taken, "opened")

    def is_over_time(self, axis: str) -> bool:
        """Return whether an axis is one of times, which is possible on the tab of runs."""
        return bool(axis == RUNS and self.desk.over_time)

    def page_run(self) -> PageRun:
        """Return the plan: a measured run stands beside it, and its file in no scenario."""
        plan = super().page_run()
        note = "The page shows measured runs, whose files no scenario file has; this is the plan."
        return PageRun(plan.program, plan.changes, note) if self.tab == RUNS and self.measured is not None else plan

    # ---- files

    def bring(self, named: Iterable[tuple[str, bytes]]) -> None:
        """Take files, each given by its name and content: scenarios and studies are opened, all others read."""
        self.refusal = ""
        for name, content in named:
            suffix = PurePath(name).suffix.lower()
            if suffix in STUDIES:
                self.desk.turn_to("Explore", brought=(name, content))
            elif suffix in (*SCENARIOS, *REPORTS):
                self._open_scenario(name, content)
            else:
                self.add(name, content)

    def _bring_dropped(self, *_: Any) -> None:
        if self.dropped is not None:
            self.bring([self.dropped])
            # the same file may be dropped once more
            self.dropped = None

    def add(self, name: str, content: bytes, is_example: bool = False) -> None:
        """Take a file, of a workbook its tables of a line, or say why not; one of the same name is replaced."""
        name = "".join(letter if letter.isprintable() else " " for letter in name)[:LONGEST_NAME] or "a file"
        if len(content) > LARGEST_RUN_BYTES:
            self.refusal = too_large(name)
            return
        brought = split_workbook(name, content) or [Brought(0, name, content, is_example=is_example)]
        names = {name, *(file.name for file in brought)}
        others = tuple(file for file in self.files if file.name not in names)
        if len(others) + len(brought) > MAX_FILES:
            self.refusal = f"{name}: at most {MAX_FILES} files at a time; remove one first."
            return
        numbers = count(self._count + 1)
        self._count += len(brought)
        self.files = (*others, *(replace(file, number=number) for file, number in zip(brought, numbers, strict=False)))

    def _open_scenario(self, name: str, content: bytes) -> None:
        try:
            self.desk.scenario.open(scenario_text(content.decode(), name), name)
        except UnicodeDecodeError:
            self.refusal = refused_file(name, NO_TEXT)
        except RailjouleError as refusal:
            self.refusal = words_of(refusal, name)
        else:
            self.desk.page = "Drive"

    def try_example(self, *_: Any) -> None:
        """Show the example of the tab: files of a line, or runs on the line on which they were made."""
        if self.tab == LINE:
            self.bring((source.name, source.content) for source in sources(EXAMPLE_LINE))
            return
        scenario, before = self.desk.scenario, self.desk.scenario.edited.title
        if scenario.opened is not None or scenario.preset != EXAMPLE_SCENARIO:
            scenario.choose(EXAMPLE_SCENARIO)
            now = scenario.edited.title
            self.desk.notice = (
                f"{now}, on which the example was recorded, has replaced {before}. Undo brings that back."
            )
        self.param.update(example=True, shown=sources(EXAMPLE_RUNS)[0].name, refusal="")

    def _bring_example(self, *_: Any) -> None:
        """Add or remove the example runs, as a link or a step back requires."""
        self.files = tuple(file for file in self.files if not file.is_example)
        if self.example:
            with param.parameterized.batch_call_watchers(self):
                for source in sources(EXAMPLE_RUNS):
                    self.add(source.name, source.content, is_example=True)

    def _turn_to_newest(self, *_: Any) -> None:
        """Show the tab of the latest file, and the last of several runs; again when the user chooses its kind."""
        newest = self.cards[-1] if self.cards else None
        if newest is None or (newest.number, newest.kind) == self._newest:
            return
        self._newest = newest.number, newest.kind
        is_example = next((file.is_example for file in self.files if file.number == newest.number), True)
        runs = newest.result if newest.is_run else ()
        # what a link or a button names stays
        shown = {"shown": runs[-1].name} if runs and not is_example else {}
        self.param.update(tab=RUNS if newest.is_run else LINE, **shown)

    # ---- what it shows

    def layout(self) -> Viewable:
        """Make the field for files, the tabs, and the parts of the open tab."""
        place: dict[str, Any] = {"variant": "outlined", "size": "small", "margin": (8, 8, 0, 0)}
        self.chooser = SmallFile(
            refuse=lambda: setattr(self, "refusal", too_large("The file")),
            label="Choose files",
            uploaded_label="Choose files",
            accept=",".join((*FILE_SUFFIXES, *SCENARIOS, *REPORTS, *STUDIES)),
            multiple=True,
            max_file_size=LARGEST_RUN_BYTES,
            icon="folder_open",
            **place,
        )
        self.chooser.param.watch(self._take_chosen, "value")
        example = pmui.Button(label="Try the example", on_click=self.try_example, height=30, **place)
        self.refused = parts.html_pane(visible=False)
        self.invitation = parts.html_pane(stylesheets=[parts_css(), INVITATION_CSS])
        self.sheet = SheetForm(self.add)
        sheet = parts.stack(self.sheet.view, css=padded("0 20px", "0 14px"))
        tools = parts.stack(pn.FlexBox(self.chooser, example, margin=0), css=padded("0 20px", "0 14px"))
        self.tabs = PageTabs(self, TABS, {LINE: self.layout_line, RUNS: self.layout_runs})
        return parts.stack(self.refused, tools, self.tabs.view, self.invitation, sheet)

    def _take_chosen(self, *_: Any) -> None:
        """Take the files that were chosen, which come as one or as a list."""
        contents, names = self.chooser.value, self.chooser.filename
        if contents:
            self.bring(
                zip(map(str, names), contents, strict=True) if isinstance(contents, list) else [(str(names), contents)]
            )

    @shows("scenario", "refusal", "failure", "tab", "files", "measured")
    def _show_heading(self) -> None:
        self.host.tell(self.failure, "")
        subtitle = texts.subtitle(self.measured) if self.tab == RUNS and self.measured is not None else ""
        self.host.heading.object = parts.heading(self.page, self.desk.scenario.edited.title, subtitle, "")
        self.refused.visible = bool(self.refusal)
        self.refused.object = parts.refusal(self.refusal) if self.refusal else ""
        is_empty = not (self.runs if self.tab == RUNS else [card for card in self.cards if not card.is_run])
        sentences, head, rows = texts.INVITATION[self.tab]
        table = parts.table("Accepted files", head, [(row, False) for row in rows])
        self.invitation.object = parts.finding(sentences) + table if is_empty else Markup("")
        self.sheet.view.visible = self.tab == LINE
