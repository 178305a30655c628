"""Keys of a file in sentences that pages show."""

import pytest

from railjoule.dashboard.look.key_names import without_keys


@pytest.mark.parametrize(
    ("sentence", "shown"),
    [
        (
            "disturbance.coordinate_error_m = 500 must be less than the shortest distance between two stops, 300 m.",
            "Position error = 500 m must be less than the shortest distance between two stops, 300 m.",
        ),
        (
            "takes at most 1,000 cells, and solver.mesh_m = 0.01 makes 130,000.",
            "takes at most 1,000 cells, and mesh = 0.01 m makes 130,000.",
        ),
        (
            "the neutral section from 3 to 5 m (line.neutral_sections), friction brakes of at most 3 kN",
            "the neutral section from 3 to 5 m, friction brakes of at most 3 kN",
        ),
        ("search.limits_kmh[1] = 900 must be at most 80.", "Limits[1] = 900 km/h must be at most 80."),
        ("drive.machine is missing.", "Machine is missing."),
        ("line.csv: row 3 (a.line.toml) has no place.", "line.csv: row 3 (a.line.toml) has no place."),
    ],
)
def test_a_field_stands_in_the_place_of_its_key(sentence: str, shown: str) -> None:
    assert without_keys(sentence) == shown
