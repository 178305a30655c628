"""My files: the list of a workspace's files on one open page, and what is done to them.

The disk may be slow, and a file long: everything that touches it is done in a thread, one thing after another.
"""

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import PurePath
from typing import Any, TypeVar

import panel as pn
import param

from railjoule.core import RailjouleError, Scenario
from railjoule.core.budget import PAGE, within
from railjoule.core.scenario import format_scenario, parse_scenario
from railjoule.core.scenario.vehicle import Vehicle
from railjoule.core.workspace import Deleted, Kind, Listing, OwnFile, Stamp, Workspace, WorkspaceError, kind_of, text_of
from railjoule.dashboard.insides import turns_of
from railjoule.dashboard.limits import LONGEST_TEXT
from railjoule.dashboard.state.opened import open_scenario
from railjoule.dashboard.state.scenario import ScenarioModel

FILE_THREADS = ThreadPoolExecutor(max_workers=1, thread_name_prefix="railjoule-files")
MOST_ORIGINS = 100
"""So many scenarios of a page are known by the file from which they come."""
OWN = "own/"
"""What a choice of one of these files begins with, among shipped ones; its name follows."""
Result = TypeVar("Result")
_served: Workspace | None = None


def serve_files_of(workspace: Workspace | None) -> None:
    """Let all pages that are opened from now on show the files of a workspace; of none on a public server."""
    global _served  # noqa: PLW0603  (one for the process, as its pages have one server)
    _served = workspace


def served_workspace() -> Workspace | None:
    """Return the workspace of this server."""
    return _served


class FilesModel(param.Parameterized):
    """The files of the server's workspace, as one page shows them."""

    listing = param.ClassSelector(class_=Listing, default=Listing(), doc="What is in the workspace.")
    deleted = param.ClassSelector(class_=Deleted, default=None, allow_None=True, doc="What was deleted last.")
    current = param.ClassSelector(
        class_=OwnFile, default=None, allow_None=True, doc="The file of the scenario, as it was opened or saved."
    )
    refusal = param.String(default="", doc="Why the last thing that was asked of the list was not done.")

    def __init__(self, scenario: ScenarioModel, **params: Any) -> None:
        super().__init__(**params)
        self.scenario, self.workspace = scenario, served_workspace()
        self._origins: dict[str, OwnFile] = {}
        self._unreadable = ""
        scenario.param.watch(self._find_current, ["opened", "toml"])

    @property
    def there(self) -> bool:
        """Whether the server has a workspace."""
        return self.workspace is not None

    def named(self, kind: str, name: str) -> OwnFile | None:
        """Return the listed file of a name; None where there is none any more."""
        return next((file for file in self.listing.files if (file.kind, file.name) == (kind, name)), None)

    def options(self, kind: str) -> dict[str, str]:
        """Return what the files of a kind are called among shipped ones, with the value of each choice."""
        return {f"{file.name} (my files)": f"{OWN}{file.name}" for file in self.listing.files if file.kind == kind}

    def chosen(self, kind: str, value: str) -> OwnFile | None:
        """Return the file that a choice names; None where it names none."""
        return self.named(kind, value.removeprefix(OWN)) if value.startswith(OWN) else None

    @property
    def is_changed(self) -> bool:
        """Whether the scenario's file was changed, or has gone, since it was opened."""
        file = self.current
        if file is None:
            return False
        now = self.named(file.kind, file.name)
        return now is None or now.stamp != file.stamp

    def whole(self, toml: str, name: str) -> str:
        """Return the text of a scenario with own vehicles and lines that it may name put into it.

        Raises
        ------
        RailjouleError
            If anything is wrong in it.
        """
        own = [file.name for file in self.listing.files if file.kind in {"vehicles", "lines"}]
        if self.workspace is None or not any(one in toml for one in own):
            return toml
        with within(PAGE):
            return format_scenario(parse_scenario(toml, name, own=self.workspace))

    # ---- what is asked

    def look(self) -> None:
        """Look at the folder again; where nothing is otherwise, nobody hears of it."""
        if self.workspace is not None:
            self._do(self.workspace.listing, self._list, self._take_unreadable)

    def open(self, file: OwnFile, then: Callable[[], None] = lambda: None) -> None:
        """Take the scenario of a file, or use its vehicle or line in the scenario; then go on."""

        def take(made: tuple[Stamp, str | dict[str, Any]]) -> None:
            self._take(file, *made)
            then()

        if file.kind != "runs":
            self._ask(lambda: self._read(file), take)

    def open_run(self, file: OwnFile, show: Callable[[str, bytes], None]) -> None:
        """Hand over the name and the content of a run's file."""
        if file.kind == "runs":
            name = f"{file.name}{file.suffix}"
            self._ask(lambda: self._workspace.read(file)[0], lambda text: show(name, text.encode()))

    def rename(self, file: OwnFile, name: str) -> None:
        """Give a file another name."""

        def take(renamed: OwnFile) -> None:
            for toml, origin in self._origins.items():
                if (origin.kind, origin.name) == (file.kind, file.name):
                    self._origins[toml] = OwnFile(file.kind, renamed.name, file.suffix, origin.stamp)
            self._find_current()

        self._ask(lambda: self._workspace.rename(file, name), take)

    def duplicate(self, file: OwnFile) -> None:
        """Copy a file."""
        self._ask(lambda: self._workspace.duplicate(file), lambda _: None)

    def delete(self, file: OwnFile) -> None:
        """Delete a file; it can be taken back."""
        self._ask(lambda: self._workspace.delete(file), lambda deleted: self.param.update(deleted=deleted))

    def restore(self) -> None:
        """Take back what was deleted last."""
        deleted = self.deleted
        if deleted is not None:
            self._ask(lambda: self._workspace.restore(deleted), lambda _: self.param.update(deleted=None))

    def add(self, file_name: str, text: str) -> None:
        """Put a file that a user brings into the workspace."""
        workspace = self._workspace

        def save() -> OwnFile:
            if len(text) > LONGEST_TEXT:
                raise WorkspaceError(f"{file_name}: more than the {LONGEST_TEXT / 1e6:g} MB allowed.")
            kind, suffix = kind_of(file_name, text, workspace)
            return workspace.save(kind, PurePath(file_name).stem, text, suffix=suffix)

        self._ask(save, lambda _: None)

    def save(
        self,
        kind: Kind,
        name: str,
        make: Callable[[], str | Scenario],
        replaces: Stamp | None,
        then: Callable[[OwnFile, str], None],
        fail: Callable[[RailjouleError], None],
    ) -> None:
        """Save something under a name.

        Parameters
        ----------
        kind, name : str
        make : callable
            Returns the text, or the scenario of which it is made; called in a thread.
        replaces : Stamp or None
            That of the file which is to be replaced.
        then, fail : callable
            Called with the file and its scenario as a text that needs no other file, or with what is wrong.
        """
        workspace = self._workspace

        def save() -> tuple[OwnFile, str]:
            made, toml = make(), ""
            text = made if isinstance(made, str) else text_of(kind, made, workspace)
            if isinstance(made, Scenario) and kind == "scenarios":
                # before it is saved: what no page could open again is not
                toml = open_scenario(format_scenario(made), name).toml
            return workspace.save(kind, name, text, replaces), toml

        def take(saved: tuple[OwnFile, str]) -> None:
            file, toml = saved
            if toml:
                self._origins[toml] = file
            then(file, toml)
            self._find_current()
            self.look()

        def refuse(error: RailjouleError) -> None:
            fail(error)
            self.look()

        self._do(save, take, refuse)

    # ---- what comes of it

    @property
    def _workspace(self) -> Workspace:
        if self.workspace is None:
            raise RailjouleError("This server keeps no files.")
        return self.workspace

    def _read(self, file: OwnFile) -> tuple[Stamp, str | dict[str, Any]]:
        """Return the stamp of a file, and its scenario as a text or its vehicle or line as a document."""
        workspace = self._workspace
        text, stamp = workspace.read(file)
        if file.kind != "scenarios":
            return stamp, workspace.document(file.kind, file.name)  # type: ignore[arg-type]
        with within(PAGE):
            scenario = parse_scenario(text, file.name, workspace.beside("scenarios"), own=workspace)
        # here, so that the page finds it in the cache
        return stamp, open_scenario(format_scenario(scenario), file.name).toml

    def _take(self, file: OwnFile, stamp: Stamp, content: str | dict[str, Any]) -> None:
        if isinstance(content, str):
            self._origins[content] = OwnFile(file.kind, file.name, file.suffix, stamp)
            while len(self._origins) > MOST_ORIGINS:
                del self._origins[next(iter(self._origins))]
            self.scenario.open(content, file.name)
        else:
            self.use(file.kind, content)

    def use(self, kind: Kind, document: dict[str, Any]) -> None:
        """Lay a whole vehicle or line over the scenario's.

        Raises
        ------
        RailjouleError
            If no train can run what comes out; then nothing changes.
        """
        if kind == "vehicles":
            # as many on board as before, as far as this vehicle carries them
            vehicle = Vehicle.model_validate(document)
            most = vehicle.crush_load_factor if vehicle.capacity_passengers * vehicle.passenger_mass_kg else 0.0
            load = min(self.scenario.scenario().vehicle.load_factor, most)
            self.scenario.edit({"vehicle": {**document, "load_factor": load}, "drive": None})
        else:
            self.scenario.edit({"line": document})

    def _find_current(self, *_: Any) -> None:
        toml = self.scenario.toml
        self.current = None if toml is None else self._origins.get(toml)

    def _list(self, listing: Listing) -> None:
        if self._unreadable and self.refusal == self._unreadable:
            self.refusal = ""
        self._unreadable = ""
        if listing != self.listing:
            self.listing = listing

    def _refuse(self, error: RailjouleError) -> None:
        self.refusal = str(error)

    def _take_unreadable(self, error: RailjouleError) -> None:
        # told until the folder can be read again, and only once
        if str(error) != self._unreadable:
            self.refusal = self._unreadable = str(error)

    def _refuse_and_look(self, error: RailjouleError) -> None:
        self._refuse(error)
        self.look()

    def _ask(self, act: Callable[[], Result], then: Callable[[Result], None]) -> None:
        """Do what was asked of the list, and show how it is then."""

        def take(result: Result) -> None:
            then(result)
            self.refusal = ""
            self.look()

        self.refusal = ""
        self._do(act, take, self._refuse_and_look)

    def _do(
        self,
        act: Callable[[], Result],
        then: Callable[[Result], None],
        fail: Callable[[RailjouleError], None],
    ) -> None:
        """Act in a thread, then go on in a turn of the page; without a page at once."""
        document = pn.state.curdoc

        def take(outcome: Future[Result]) -> None:
            try:
                then(outcome.result())
            except RailjouleError as error:
                fail(error)

        if document is not None:
            turn = turns_of(document)
            FILE_THREADS.submit(act).add_done_callback(lambda outcome: turn(lambda: take(outcome)))
            return
        done: Future[Result] = Future()
        try:
            done.set_result(act())
        except Exception as error:  # as a thread would keep it
            done.set_exception(error)
        take(done)
