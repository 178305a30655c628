"""Refusals of strategies, as sentences that name them."""

from collections.abc import Iterator
from contextlib import contextmanager

from railjoule.core import Scenario, StrategyRefusedError
from railjoule.dashboard.look.words import STRATEGY_WORDS


@contextmanager
def named_refusals(scenario: Scenario) -> Iterator[None]:
    """Let a refusal of a scenario's strategy name that strategy."""
    try:
        yield
    except StrategyRefusedError as refusal:
        raise StrategyRefusedError(f"{STRATEGY_WORDS[scenario.strategy]}: {refusal}") from None
