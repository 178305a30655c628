"""One small paper: its descriptions become rows and verdicts."""

import tomllib
from types import SimpleNamespace

import pytest

from railjoule.core.validation import papers

FILE = """
authors = ["B A"]
title = "T"
journal = "J"
year = 2025
erratum = []

[notes]
off = "{difference:.1f} Wh more."

[[entries]]
time_s = 270
energy_wh = 10.0

[[entries]]
time_s = 300
energy_wh = 8.0

[[comparison]]
title = "Energies"
place = "Table 1"

[[comparison.groups]]
compute = "energy"
each = "entries"
case = "{time_s} s"
source = "Table 1, {case}, {quantity}"
rows = [
    {quantity = "W", unit = "Wh", printed = "energy_wh", value = "energy_wh", note = "off", when = "difference"},
    {quantity = "twice", value = "both[1]", source = ""},
]

[[comparison.groups]]
compute = "speeds"
each = [3]
case = "{name}"
quantity = "{argument} times"
value = "speed"
note = "The {name} train."
rows = [{}]

[[claim]]
place = "section 1"
text = "It is little."
compute = "speeds"
of = 1
holds_between = {"all[0][speed]" = [0, 2], "all[1][speed]" = [0, 3]}
found = "{all[1][speed]:.1f} m/s"
reason = "The {all[1][name]} one."

[[claim]]
place = "section 2"
text = "It is more."
kind = "more"
of = {energy_wh = 8.0}

[[claim]]
place = "section 3"
text = "It is open."
found = "no number"
reason = "It is not defined."

[kinds.more]
compute = "energy"
holds_between = {difference = [0, inf]}
found = "{difference:g} Wh"
reason = "Computed."
"""


@pytest.fixture
def comparison(monkeypatch):
    def energy(entry):
        own = max(entry["energy_wh"], 9.0)
        return {"energy_wh": own, "difference": own - entry["energy_wh"], "both": [own, 2 * own]}

    def speeds(factor):
        return [{"name": "slow", "speed": factor}, {"name": "fast", "speed": 2.0 * factor}]

    monkeypatch.setattr(papers, "printed_numbers", lambda name: tomllib.loads(FILE))
    return papers.compare("some-2025", SimpleNamespace(energy=energy, speeds=speeds), ())


def test_rows_have_printed_and_computed_numbers(comparison):
    (table,) = (compute() for compute in comparison.tables)
    assert (comparison.paper, comparison.citation) == ("some", "A: T, J, 2025")
    assert (table.title, table.place, table.reference) == ("Energies", "Table 1", "printed")
    rows = [(row.case, row.quantity, row.unit, row.printed, row.value, row.note, row.source) for row in table.rows]
    assert rows == [
        ("270 s", "W", "Wh", 10.0, 10.0, "", "Table 1, 270 s, W"),
        ("270 s", "twice", "", None, 20.0, "", ""),
        ("300 s", "W", "Wh", 8.0, 9.0, "1.0 Wh more.", "Table 1, 300 s, W"),
        ("300 s", "twice", "", None, 18.0, "", ""),
        ("slow", "3 times", "", None, 3.0, "The slow train.", ""),
        ("fast", "3 times", "", None, 6.0, "The fast train.", ""),
    ]


def test_verdicts_follow_from_the_bounds(comparison):
    claims = [examine() for examine in comparison.claims]
    assert [(claim.found, claim.verdict, claim.reason) for claim in claims] == [
        ("2.0 m/s", "supports", "The fast one."),
        ("1 Wh", "supports", "Computed."),
        ("no number", "cannot be decided", "It is not defined."),
    ]


def test_a_quantity_at_a_bound_refutes(monkeypatch):
    text = FILE.replace("[0, 3]", "[0, 2]")
    monkeypatch.setattr(papers, "printed_numbers", lambda name: tomllib.loads(text))
    module = SimpleNamespace(speeds=lambda factor: [{"name": "", "speed": 1.0}, {"name": "", "speed": 2.0}])
    claim, *_ = papers.compare("some-2025", module, ()).claims
    assert claim().verdict == "refutes"
