"""The work behind the page Start: the cards of the shipped scenarios."""

from typing import Any

from railjoule.core import RailjouleError
from railjoule.dashboard.models.workbench import Workbench
from railjoule.dashboard.store import Card, Study, card_names, compute_cards
from railjoule.dashboard.warmup import warmup

PAGE = "Start"


class Start:
    """Asks for the cards of one page, once it is in sight and the kernels are ready."""

    def __init__(self, state: Workbench) -> None:
        self.state = state
        self.cards = Study(compute_cards, self._take, self._take_failure)
        self._asked = False
        state.param.watch(self.ask, ["page", "runs"])

    def end(self) -> None:
        """End what still runs: the page is gone."""
        self.cards.stop()

    def ask(self, *_: Any) -> None:
        """Ask for the cards, unless that is done."""
        if self.state.page == PAGE and not self._asked and warmup().ready.is_set():
            self._asked = True
            self.cards.ask(card_names())

    def _take(self, cards: tuple[Card, ...], _last: bool) -> None:
        self.state.start.cards = list(cards)

    def _take_failure(self, failure: RailjouleError) -> None:
        self.state.failure = failure
