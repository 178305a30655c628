"""The work behind Import: files are read in a thread, and the scenario that is taken is checked in one."""

from typing import Any

from railjoule.core import RailjouleError
from railjoule.dashboard.pages.imports.compute import Offer, Reading, Request, read_files, taken, waiting_words
from railjoule.dashboard.pages.imports.model import ImportModel, Wanted
from railjoule.dashboard.state.opened import Opened, open_scenario
from railjoule.dashboard.state.page_work import PageWork
from railjoule.dashboard.state.scenario import PLAN_FIELDS
from railjoule.dashboard.state.workbench import Workbench

SOURCE = "the import"


class Imports(PageWork[ImportModel]):
    """Reads the files of one page while it is in sight."""

    page = "Import"

    def __init__(self, state: Workbench) -> None:
        super().__init__(state, state.imports)
        self.reading = self.study(read_files, self._take_reading)
        self.taking = self.worker(_opened, self._open, self._refuse)
        self.model.param.watch(self.ask, ["files", "stretch"])
        self.model.param.watch(self._take_wanted, "wanted")
        # a vehicle is offered with the line beside the page, and a line with its vehicle
        state.scenario.param.watch(self.ask, list(PLAN_FIELDS))
        state.param.watch(self.ask, "page")

    def forget(self, *_: Any) -> None:
        """Forget what was asked for and end it, as the scenario has gone."""
        super().forget()
        self.reading.stop()

    def ask(self, *_: Any) -> None:
        """Read all files, unless nothing has changed since."""
        if not self.in_sight:
            self.rest()
            return
        scenario = self.state.scenario.scenario()
        if self.is_new((self.model.files, self.model.stretch, scenario)):
            self.reading.ask(Request(self.model.files, self.model.stretch, scenario))

    def _take_reading(self, reading: Reading, _last: bool) -> None:
        self.model.param.update(reading=reading, failure=None)

    def _take_wanted(self, *_: Any) -> None:
        """Take the scenario that is wanted with the travel time that was typed."""
        wanted: Wanted | None = self.model.wanted
        if wanted is None:
            return
        offers: tuple[Offer, ...] = self.model.reading.offers or ()
        offer = next((one for one in offers if one.what == wanted.what and not one.failure), None)
        if offer is None:
            return
        if offer.waits_for and not wanted.without:
            self.model.refusal = waiting_words(offer)
            return
        try:
            time_s = float(wanted.time.replace(",", "."))
        except ValueError:
            self.model.refusal = f"Travel time: {wanted.time!r} must be a number of seconds, such as {offer.time_s:g}."
            return
        self.taking.ask((offer, time_s))

    def _open(self, opened: Opened) -> None:
        # from the cache of `open_scenario`, as the thread has just read it
        self.state.scenario.open(opened.toml, SOURCE)
        self.model.refusal = ""
        self.state.page = "Drive"

    def _refuse(self, error: RailjouleError) -> None:
        self.model.refusal = str(error)


def _opened(asked: tuple[Offer, float]) -> Opened:
    return open_scenario(taken(*asked), SOURCE)
