"""The work behind the page Start: the cards of the shipped scenarios."""

from typing import Any

from railjoule.dashboard.pages.start.compute import Card, card_names, compute_cards, compute_fastest_cards
from railjoule.dashboard.state.page_work import PageWork
from railjoule.dashboard.state.workbench import Workbench
from railjoule.dashboard.work.warmup import warmup


class Start(PageWork[Workbench]):
    """Asks for the cards of one page, once it is in sight and the kernels are ready."""

    page = "Start"

    def __init__(self, state: Workbench) -> None:
        super().__init__(state, state)
        self.cards = self.study(compute_cards, self._take)
        self.fastest = self.study(compute_fastest_cards, self._take)
        self._begun = self._has_fastest = False
        state.param.watch(self.ask, ["page", "runs"])

    def ask(self, *_: Any) -> None:
        """Ask for the cards, unless that is done; while kernels compile, for those of the fastest runs."""
        if self.state.page != self.page or self._begun:
            return
        if warmup().ready.is_set():
            self._begun = True
            self.cards.ask(card_names())
        elif warmup().compiles and warmup().fastest.is_set() and not self._has_fastest:
            self._has_fastest = True
            self.fastest.ask(card_names())

    def _take(self, cards: tuple[Card, ...], _last: bool) -> None:
        self.state.start.cards = list(cards)
