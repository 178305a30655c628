"""Scenarios that a user brings as texts, read once: a page asks for the same text several times over."""

from dataclasses import dataclass
from functools import lru_cache

from railjoule.core import RailjouleError, Scenario, ScenarioError
from railjoule.core.budget import PAGE, within
from railjoule.core.scenario import format_scenario, parse_scenario
from railjoule.core.strategies import prepare_task
from railjoule.dashboard.limits import LONGEST_TEXT

SOURCE = "scenario"


@dataclass(frozen=True)
class Opened:
    """A scenario that some train can run, and the text that is kept of it."""

    scenario: Scenario
    toml: str


def open_scenario(text: str, name: str) -> Opened:
    """Return the scenario of a text; a text that was read before is not read again.

    Parameters
    ----------
    text : str
        The TOML.
    name : str
        What it is called.

    Raises
    ------
    RailjouleError
        If it cannot be read, is too large for a page, or no train can run it.
    """
    outcome = outcome_of(text)
    if isinstance(outcome, Opened):
        return outcome
    raise type(outcome)(f"{name}: {str(outcome).removeprefix(f'{SOURCE}: ')}")


# keyed by the text alone, as `open_scenario` lays the file's name on; eight texts have at most 16 MB (LONGEST_TEXT)
@lru_cache(maxsize=8)
def outcome_of(text: str) -> Opened | RailjouleError:
    """Return the scenario of a text or why there is none; long texts may be read here in a thread beforehand."""
    if len(text) > LONGEST_TEXT:
        return ScenarioError(f"{SOURCE}: more than the {LONGEST_TEXT / 1e6:g} MB allowed.")
    try:
        with within(PAGE):
            scenario = parse_scenario(text, SOURCE)
            prepare_task(scenario)
        return Opened(scenario, format_scenario(scenario))
    except RailjouleError as error:
        # returned, not raised, as the cache keeps no exceptions: a refused text is not read again either
        return error
    except MemoryError:
        return ScenarioError(f"{SOURCE}: not enough memory on the server to read it.")
