"""Keys of earlier addresses, so that their links still open."""

from collections.abc import Mapping

CONDITIONS = (
    *("actual_load_percent", "coordinate_error_m", "speed_error_percent", "target_braking"),
    *("reset_sensor_m", "calibration_length_m", "stop_sensor_m", "target_deceleration_ms2"),
    *("d1_error_m", "d2_error_m", "d3_error_m"),
    *("load_deviation_percent", "error_deviation_m", "resistance_deviation_percent", "voltage_deviation_percent"),
    *("speed_deviation_percent", "sensor_deviation_m", "mean_departure_delay_s", "seed"),
)
FORMER_KEYS: Mapping[str, str] = {
    **{f"robustness.{field}": f"day.{field}" for field in CONDITIONS},
    **{f"robustness.{field}": f"what_if.{field}" for field in ("both_directions", "knows", "measure")},
    **{f"robustness.{field}": f"what_if.{field}" for field in ("probability_percent", "candidates")},
    "robustness.accepted_delay_s": "what_if.accepted_lateness_s",
    **{f"disturbances.{field}": f"day.{field}" for field in ("events", "accepted_delay_s")},
    **{f"actual.{field}": f"day.{field}" for field in ("on", "reaction")},
}
"""By earlier key the present one."""
FORMER_PAGES: Mapping[str, Mapping[str, str]] = {
    "Robustness": {"page": "What if", "what_if.tab": "load"},
    "Disturbances": {"page": "What if", "what_if.tab": "events"},
}
"""By the name of an earlier page, the values that open its successor."""
