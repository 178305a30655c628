"""The line in the sidebar, as people read it."""

from railjoule.dashboard.shell.sidebar import line_rows
from railjoule.dashboard.workbench import Workbench


def test_limits_and_stretches_are_written_as_people_read_them() -> None:
    state = Workbench()
    # 40 mph, and places of four digits
    limit = {"from_m": 1500.0, "to_m": 1800.25, "limit_kmh": 40 * 1.609344}
    rails = {"from_m": 0.0, "to_m": 1200.0, "condition": "wet"}
    state.scenario.edit({"line.speed_limits": [limit], "line.rail_conditions": [rails]})
    rows = line_rows(state)
    assert "<span>2.30 km, \u221230 to +17 \u2030</span>" in rows
    assert "<span>Limit 64.4 km/h</span><span>1\u202f500\u20131\u202f800.2 m</span>" in rows
    assert "<span>Wet rails</span><span>0\u20131\u202f200 m</span>" in rows
