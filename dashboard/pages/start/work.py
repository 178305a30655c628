"""The work behind the page Start: the cards of the shipped scenarios."""

from typing import Any

from railjoule.dashboard.pages.start.compute import Card, card_names, compute_cards
from railjoule.dashboard.state.page_work import PageWork
from railjoule.dashboard.state.workbench import Workbench


class Start(PageWork[Workbench]):
    """Asks for the cards of one page, once it is in sight and the kernels are ready."""

    page = "Start"

    def __init__(self, state: Workbench) -> None:
        super().__init__(state, state)
        self.cards = self.study(compute_cards, self._take)
        self._begun = False
        state.param.watch(self.ask, ["page", "runs"])

    def ask(self, *_: Any) -> None:
        """Ask for the cards, unless that is done."""
        if self.in_sight and not self._begun:
            self._begun = True
            self.cards.ask(card_names())

    def _take(self, cards: tuple[Card, ...], _last: bool) -> None:
        self.state.start.cards = list(cards)
