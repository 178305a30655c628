"""Fixtures of manual driving."""

import pytest

from railjoule.core import Scenario, load_scenario
from railjoule.core.motion import MeshedLine, build_meshed_line


@pytest.fixture(scope="module")
def scenario() -> Scenario:
    """A metro with gradients and a limit."""
    return load_scenario("metro-with-limit")


@pytest.fixture(scope="module")
def mesh(scenario: Scenario) -> MeshedLine:
    """Its meshed line."""
    return build_meshed_line(scenario)
