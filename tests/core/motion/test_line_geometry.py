"""Limits, curves and stops of a line over its mesh."""

import numpy as np
import pytest
from builders import HILLS, plain_scenario

from railjoule.core.motion.line_geometry import geometry_at, meshed_geometry
from railjoule.core.scenario import Line

LINE = Line.model_validate(
    {
        "sections": HILLS,
        "speed_limits": [
            {"from_m": 600, "to_m": 900, "limit_kmh": 50},
            {"from_m": 800, "to_m": 1000, "limit_kmh": 90},
        ],
        "stations": [{"position_m": 1500, "dwell_s": 20}],
    }
)


def test_the_lower_limit_holds_where_two_meet():
    geometry = meshed_geometry(LINE, 10.0, None, None)
    limit = dict(zip(geometry.position_m.round(6), geometry.speed_limit_ms * 3.6, strict=True))
    assert limit[590] == np.inf
    assert limit[600] == pytest.approx(50)
    assert limit[900] == pytest.approx(50)
    assert limit[910] == pytest.approx(70)  # the section's own limit is lower than 90
    assert limit[1200] == pytest.approx(70)
    assert limit[1210] == np.inf


def test_stops_and_dwells():
    geometry = meshed_geometry(LINE, 10.0, None, None)
    (stop,) = geometry.stop_nodes
    assert geometry.position_m[stop] == pytest.approx(1500)
    assert geometry.dwell_s[stop] == 20
    assert geometry.dwell_s.sum() == 20


def test_curvature_is_one_over_radius():
    geometry = geometry_at(LINE, np.array([0.0, 1200.0, 1700.0, 2000.0]), None, None)
    assert geometry.curvature_per_m == pytest.approx([0, 1 / 300, 0])


def test_reverse_turns_limits_and_stops():
    turned = meshed_geometry(LINE.model_copy(update={"reverse": True}), 10.0, None, None)
    forward = meshed_geometry(LINE, 10.0, None, None)
    assert turned.position_m == pytest.approx(2000 - forward.position_m[::-1])
    assert turned.speed_limit_ms == pytest.approx(forward.speed_limit_ms[::-1])
    assert turned.gradient_permille == pytest.approx(-forward.gradient_permille[::-1])
    assert turned.dwell_s == pytest.approx(forward.dwell_s[::-1])


def test_arrays_cannot_be_written_to():
    geometry = meshed_geometry(plain_scenario().line, 10.0, None, None)
    assert geometry is meshed_geometry(plain_scenario().line, 10.0, None, None)
    for values in (geometry.position_m, geometry.gradient_permille, geometry.speed_limit_ms):
        with pytest.raises(ValueError, match="read-only"):
            values[0] = 1.0
