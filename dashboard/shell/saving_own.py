"""Saving to My files, in the sidebar: the scenario, its vehicle, its line or the run that is shown."""

from collections.abc import Callable
from typing import Any, cast

import param

from railjoule.core import RailjouleError, Scenario
from railjoule.core.csv_text import csv_of_table
from railjoule.core.scenario.file_names import same_name_key
from railjoule.core.workspace import KINDS, WORDS, Kind, OwnFile
from railjoule.dashboard.browser.messages import added_to
from railjoule.dashboard.editor.forms import Form
from railjoule.dashboard.keep.keeping import Keeping
from railjoule.dashboard.look.scripts import module
from railjoule.dashboard.parts.html import stack
from railjoule.dashboard.shell.share import file_name
from railjoule.dashboard.shell.text_button import text_button
from railjoule.dashboard.state.recipes import recipe_of
from railjoule.dashboard.state.workbench import Workbench

CHOICES = (
    ("scenarios", "Scenario"),
    ("vehicles", "Vehicle with powertrain"),
    ("lines", "Line"),
    ("runs", "Run that is shown"),
)
NO_RUN = "There is no run yet."
SAVED = "Saved as {} {}."


class SaveForm(Form):
    """What is saved, and under which name."""

    kinds = param.List(default=[list(choice) for choice in CHOICES], doc="What can be saved.")
    names = param.Dict(default={}, doc="A name for each kind.")
    refusal = param.String(default="", doc="Why it was not saved.")
    can_replace = param.Boolean(default=False, doc="Whether the file that is there may be replaced.")
    told = param.String(default="", doc="What was saved.")
    version = param.Integer(default=0, doc="Counts what was sent: the browser redraws at each.")

    _esm = module("save_form")


class SavingOwn:
    """The button that opens the form, and what the form does; nothing where the server has no workspace."""

    def __init__(self, state: Workbench, keeping: Keeping) -> None:
        self.state, self.keeping, self.files = state, keeping, state.files
        self.button = text_button("Save to My files", "save", self._turn)
        self.form = SaveForm(self._hear)
        # in a stack, as the form's own sheet would show it where it is hidden; and not before it is asked for, as it
        # would cost every page that opens
        self.place = stack(visible=False)
        self.view = stack(*([self.button, self.place] if self.files.there else []), visible=self.files.there)
        self._offered: OwnFile | None = None
        self.files.param.watch(self._show, ["current", "listing"])
        state.scenario.param.watch(self._forget, ["preset", "opened", "edits"])

    def _turn(self, *_: Any) -> None:
        self.place.visible = not self.place.visible
        self._tell()
        # last: what changes in one message before it is told where it stands, the browser does not know
        if not self.place.objects:
            with added_to(self.place):
                self.place[:] = [self.form]

    def _show(self, *_: Any) -> None:
        # while a name is refused, it stays in sight beside the reason
        if self.place.visible and not self.form.refusal:
            self.form.param.update(names=self._names(), version=self.form.version + 1)

    def _forget(self, *_: Any) -> None:
        """Say no longer what was saved: it is no longer what is shown."""
        if self.place.visible:
            self._tell()

    def _tell(self, told: str = "", refusal: str = "", offered: OwnFile | None = None) -> None:
        self._offered = offered
        self.form.param.update(
            names=self._names(),
            told=told,
            refusal=refusal,
            can_replace=offered is not None,
            version=self.form.version + 1,
        )

    def _names(self) -> dict[str, str]:
        """Return a name for each kind: that of the file, else of what is in sight."""
        scenario, current = self.state.scenario.edited, self.files.current
        title = current.name if current else _slug(scenario.title)
        return {
            "scenarios": title,
            "vehicles": _slug(scenario.vehicle.name),
            "lines": _slug(scenario.line.name),
            "runs": f"{title} run",
        }

    def _hear(self, message: dict[str, Any]) -> None:
        what, kind, name = message.get("what"), message.get("kind"), str(message.get("name", ""))
        if what == "close":
            self._turn()
        elif what in {"save", "replace"} and kind in KINDS:
            self._save(cast("Kind", kind), name, what == "replace")

    def _save(self, kind: Kind, name: str, replace: bool) -> None:
        known = self._offered if replace else self.files.current
        is_known = known is not None and known.kind == kind and same_name_key(known.name) == same_name_key(name.strip())

        def take(file: OwnFile, toml: str) -> None:
            if toml:
                self.keeping.rebase(toml)
            self._tell(told=SAVED.format(WORDS[kind], file.name))

        def refuse(error: RailjouleError) -> None:
            key = same_name_key(name.strip())
            there = (file for file in self.files.listing.files if file.kind == kind and same_name_key(file.name) == key)
            self._tell(refusal=str(error), offered=next(there, None))

        try:
            make = self._made(kind)
        except RailjouleError as error:
            self._tell(refusal=str(error))
            return
        self.files.save(kind, name, make, known.stamp if known is not None and is_known else None, take, refuse)

    def _made(self, kind: Kind) -> Callable[[], str | Scenario]:
        """Return what gives the text of a file, or the scenario of which it is made."""
        if kind == "runs":
            run = self.state.run
            if run is None:
                raise RailjouleError(NO_RUN)
            return lambda: csv_of_table(run.to_dataframe())
        recipe = recipe_of(self.state)
        # a page that computes something else than the scenario, such as Papers, lays nothing over it
        scenario = recipe.scenario if recipe.program.of_scenario else self.state.scenario.scenario()
        return lambda: scenario


def _slug(title: str) -> str:
    return file_name(title).removesuffix(".toml")
