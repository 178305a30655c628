"""The fields of Robustness that the actual run and the runs of Disturbances obey, too."""

REALITY = ("actual_load_percent", "coordinate_error_m")

SENSOR_FIELDS = ("reset_sensor_m", "calibration_length_m", "stop_sensor_m", "target_deceleration_ms2")
SENSOR_ERRORS = ("d1_error_m", "d2_error_m", "d3_error_m")
FOLLOWER = ("speed_error_percent", "target_braking", *SENSOR_FIELDS, *SENSOR_ERRORS)
