"""The sections that a report can have; without imports, as the command line names them in its help."""

from collections.abc import Mapping
from types import MappingProxyType

SECTION_TITLES: Mapping[str, str] = MappingProxyType(
    {
        "result": "Result",
        "energy": "Energy, runs and phases",
        "pinned": "Pinned runs",
        "second": "Two scenarios side by side",
        "trade-off": "Energy and time",
        "proof": "Lower bound",
        "reality": "Actual run",
        "robustness": "Cost of a wrong load and a position error",
        "scenario": "Scenario",
        "file": "About this file",
    }
)
"""The titles of all sections by their names, in the order of the report."""
