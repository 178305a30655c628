"""Parts of a line as lines of their own."""

from builders import HILLS

from railjoule.core.measured.part_of_line import part_of_line
from railjoule.core.scenario import Line


def test_what_lies_across_the_ends_is_cut():
    stretches = [
        {"from_m": 100.0, "to_m": 500.0},
        {"from_m": 900.0, "to_m": 1000.0},
        {"from_m": 1400.0, "to_m": 1900.0},
    ]
    limits = [{**one, "limit_kmh": 50.0} for one in stretches]
    line = Line.model_validate({"sections": HILLS, "speed_limits": limits, "neutral_sections": stretches})
    part = part_of_line(line, 400.0, 1500.0, [])
    expected = [(0.0, 100.0), (500.0, 600.0), (1000.0, 1100.0)]
    assert [(one.from_m, one.to_m) for one in part.neutral_sections] == expected
    assert [(one.from_m, one.to_m, one.limit_kmh) for one in part.speed_limits] == [(*ends, 50.0) for ends in expected]
    assert Line.model_validate(part.model_dump()) == part
    # what the part does not touch is not there
    assert part_of_line(line, 500.0, 900.0, []).neutral_sections == ()
