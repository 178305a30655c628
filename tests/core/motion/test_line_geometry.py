"""Limits, curves and stops of a line over its mesh."""

import numpy as np
import pytest
from builders import HILLS

from railjoule.core.motion.line_geometry import geometry_at, meshed_geometry
from railjoule.core.scenario import Line
from railjoule.core.scenario.line import NeutralSection, PassingPoint

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


def test_stops_and_dwells():
    geometry = meshed_geometry(LINE, 10.0)
    (stop,) = geometry.stop_nodes
    assert geometry.position_m[stop] == pytest.approx(1500)
    assert geometry.dwell_s[stop] == 20
    assert geometry.dwell_s.sum() == 20


def test_passing_points_are_nodes():
    line = LINE.model_copy(update={"passing_points": (PassingPoint(position_m=1333.0, speed_kmh=45.0),)})
    ((node, speed),) = meshed_geometry(line, 10.0).passing_ms
    assert (meshed_geometry(line, 10.0).position_m[node], speed) == pytest.approx((1333.0, 12.5))
    # nodes of a part of the line know nothing of what lies outside
    assert geometry_at(line, np.array([0.0, 600.0, 1200.0])).passing_ms == ()
    ((node, _),) = meshed_geometry(line.model_copy(update={"reverse": True}), 10.0).passing_ms
    assert meshed_geometry(line.model_copy(update={"reverse": True}), 10.0).position_m[node] == pytest.approx(667.0)


def test_borders_of_neutral_sections_are_nodes():
    sections = (NeutralSection(from_m=1333.0, to_m=1402.5), NeutralSection(from_m=1400.0, to_m=1455.5))
    line = LINE.model_copy(update={"neutral_sections": sections})
    geometry = meshed_geometry(line, 10.0)
    inside = (geometry.position_m[:-1] >= 1333.0 - 1e-9) & (geometry.position_m[1:] <= 1455.5 + 1e-9)
    assert np.array_equal(geometry.neutral, inside)
    assert np.diff(geometry.position_m)[inside].sum() == pytest.approx(122.5)
    turned = meshed_geometry(line.model_copy(update={"reverse": True}), 10.0)
    assert turned.position_m[:-1][turned.neutral][0] == pytest.approx(2000.0 - 1455.5)


def test_curvature_is_one_over_radius():
    geometry = geometry_at(LINE, np.array([0.0, 1200.0, 1700.0, 2000.0]))
    assert geometry.curvature_per_m == pytest.approx([0, 1 / 300, 0])
