"""Fixtures of manual driving."""

import pytest

from railjoule.core import Scenario, load_scenario
from railjoule.core.motion import Course, build_course


@pytest.fixture(scope="module")
def scenario() -> Scenario:
    """A metro with gradients and a limit."""
    return load_scenario("metro-with-limit")


@pytest.fixture(scope="module")
def course(scenario: Scenario) -> Course:
    """Its course."""
    return build_course(scenario)
