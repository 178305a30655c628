"""The server's folder of scenario files as one open page lists, opens and saves them.

A disk may be slow and a file long: everything that reads or writes the folder runs in a thread, one task at a time.
"""

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any, TypeVar

import panel as pn
import param

from railjoule.core import RailjouleError, Scenario
from railjoule.core.scenario import format_scenario
from railjoule.dashboard.library_workarounds import make_turns
from railjoule.dashboard.scenario_folder import Listing, ScenarioFolder
from railjoule.dashboard.state.draft import open_scenario
from railjoule.dashboard.state.scenario import ScenarioModel

FILE_THREADS = ThreadPoolExecutor(max_workers=1, thread_name_prefix="railjoule-files")
Result = TypeVar("Result")
_served: ScenarioFolder | None = None


def serve_folder(folder: ScenarioFolder | None) -> None:
    """Set the folder that all pages list which are opened from now on; None for no folder."""
    global _served  # noqa: PLW0603  (one for the process, as its pages have one server)
    _served = folder


class FilesModel(param.Parameterized):
    """The folder of the server as one page shows it."""

    listing = param.ClassSelector(class_=Listing, default=None, allow_None=True, doc="The scenario files, once read.")
    refusal = param.String(default="", doc="Why the folder cannot be listed.")
    current = param.String(default="", doc="Name of the file of the scenario that is open; empty for none.")

    def __init__(self, scenario: ScenarioModel, **params: Any) -> None:
        super().__init__(**params)
        self.scenario, self.folder = scenario, _served
        self._origin: tuple[str | None, str] = (None, "")
        scenario.param.watch(self._find_current, ["opened", "toml"])

    def look(self) -> None:
        """List the folder again."""
        if self.folder is not None:
            self._do(self.folder.listing, self._take_listing, self._refuse)

    def open(self, name: str, then: Callable[[], None], fail: Callable[[RailjouleError], None]) -> None:
        """Open the scenario of a listed file, then go on; `fail` gets the reason why it was not opened."""

        def take(toml: str) -> None:
            self._origin = toml, name
            self.scenario.open(toml, name)
            then()

        self.read(name, take, fail)

    def read(self, name: str, then: Callable[[str], None], fail: Callable[[RailjouleError], None]) -> None:
        """Go on with the text of the scenario of a listed file; `fail` gets the reason why it cannot be read."""
        folder = self.folder
        if folder is not None:
            self._do(lambda: open_scenario(format_scenario(folder.open(name)), name).toml, then, fail)

    def save(
        self,
        name: str,
        scenario: Scenario,
        replace: bool,
        then: Callable[[str, str], None],
        fail: Callable[[RailjouleError], None],
    ) -> None:
        """Save a scenario under a name.

        Parameters
        ----------
        name : str
        scenario : Scenario
        replace : bool
            Whether a file of that name may be replaced.
        then, fail : callable
            Called with the name and the text of the file, or with the reason why it was not saved.
        """
        folder = self.folder
        if folder is None:
            return

        def save() -> tuple[str, str]:
            # a scenario that no page could open again is refused here
            toml = open_scenario(format_scenario(scenario), name).toml
            return folder.save(name, toml, replace), toml

        def take(saved: tuple[str, str]) -> None:
            self._origin = saved[1], saved[0]
            then(*saved)
            self._find_current()
            self.look()

        self._do(save, take, fail)

    def _find_current(self, *_: Any) -> None:
        toml, name = self._origin
        self.current = name if toml is not None and toml == self.scenario.toml else ""

    def _take_listing(self, listing: Listing) -> None:
        self.param.update(listing=listing, refusal="")

    def _refuse(self, error: RailjouleError) -> None:
        self.refusal = str(error)

    def _do(
        self, act: Callable[[], Result], then: Callable[[Result], None], fail: Callable[[RailjouleError], None]
    ) -> None:
        """Act in a thread, then go on in a turn of the page; without a page in this one."""
        document = pn.state.curdoc

        def take(outcome: Future[Result]) -> None:
            try:
                then(outcome.result())
            except RailjouleError as error:
                fail(error)

        if document is not None:
            turn = make_turns(document)
            FILE_THREADS.submit(act).add_done_callback(lambda outcome: turn(lambda: take(outcome)))
            return
        done: Future[Result] = Future()
        try:
            done.set_result(act())
        except Exception as error:  # as a thread would keep it
            done.set_exception(error)
        take(done)
