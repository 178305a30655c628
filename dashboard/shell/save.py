"""Saving the scenario, in the sidebar: to the server's folder, or as a download where the server has none."""

from typing import Any

import param

from railjoule.core import RailjouleError
from railjoule.dashboard.browser.messages import added_to
from railjoule.dashboard.editor.forms import Form
from railjoule.dashboard.keep.keeping import Keeping
from railjoule.dashboard.look.scripts import module
from railjoule.dashboard.parts.html import stack
from railjoule.dashboard.scenario_folder import FileExistsInFolderError
from railjoule.dashboard.shell.share import download, file_name
from railjoule.dashboard.shell.text_button import text_button
from railjoule.dashboard.state.programs import page_recipe
from railjoule.dashboard.state.workbench import Workbench


class SaveForm(Form):
    """The name under which the scenario is saved."""

    name_now = param.String(default="", doc="The suggested name.")
    refusal = param.String(default="", doc="Why it was not saved.")
    can_replace = param.Boolean(default=False, doc="Whether a file of that name may be replaced.")
    status = param.String(default="", doc="What was saved.")
    version = param.Integer(default=0, doc="Counts what was sent: the browser redraws at each.")

    _esm = module("save_form")


class SaveScenario:
    """The button in the sidebar, and the form that it opens where the server has a folder."""

    def __init__(self, state: Workbench, keeping: Keeping) -> None:
        self.state, self.keeping, self.files = state, keeping, state.files
        self.button = text_button("Save scenario", "save", self._press)
        self.form = SaveForm(self._hear)
        # in a stack, as the form's own sheet would show it where it is hidden
        self.place = stack(visible=False)
        self.view = stack(self.button, self.place)
        self.files.param.watch(self._suggest, "current")
        state.scenario.param.watch(self._clear, ["preset", "opened", "edits"])

    def _press(self, *_: Any) -> None:
        if self.files.folder is None:
            download(self.state, self.keeping)
        else:
            self._turn()

    def _turn(self) -> None:
        self.place.visible = not self.place.visible
        self._show()
        # last: the browser does not know what changes in one message before it has the form
        if not self.place.objects:
            with added_to(self.place):
                self.place[:] = [self.form]

    def _suggest(self, *_: Any) -> None:
        # a refused name stays beside its reason
        if self.place.visible and not self.form.refusal:
            self.form.param.update(name_now=self._name(), version=self.form.version + 1)

    def _clear(self, *_: Any) -> None:
        """Remove the message: the scenario is no longer the saved one."""
        if self.place.visible:
            self._show()

    def _show(self, status: str = "", refusal: str = "", can_replace: bool = False) -> None:
        self.form.param.update(
            name_now=self._name(),
            status=status,
            refusal=refusal,
            can_replace=can_replace,
            version=self.form.version + 1,
        )

    def _name(self) -> str:
        return self.files.current or file_name(self.state.scenario.edited.title).removesuffix(".toml")

    def _hear(self, message: dict[str, Any]) -> None:
        what, name = message.get("what"), str(message.get("name", ""))
        if what == "close":
            self._turn()
        elif what in {"save", "replace"}:
            self._save(name, what == "replace")

    def _save(self, name: str, replace: bool) -> None:
        def take(saved: str, toml: str) -> None:
            self.keeping.rebase(toml)
            self._show(status=f"Saved as {saved}.toml.")

        def refuse(error: RailjouleError) -> None:
            self._show(refusal=str(error), can_replace=isinstance(error, FileExistsInFolderError))

        try:
            recipe = page_recipe(self.state)
            # a page without a scenario of its own, such as Papers, changes nothing in it
            scenario = recipe.scenario if recipe.program.of_scenario else self.state.scenario.scenario()
        except RailjouleError as error:
            refuse(error)
            return
        self.files.save(name, scenario, replace, take, refuse)
