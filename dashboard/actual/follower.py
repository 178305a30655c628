"""The fields of Robustness that the actual run and the runs of Disturbances obey, too."""

REALITY = ("actual_load_percent", "coordinate_error_m")

SENSOR_FIELDS = ("reset_sensor_m", "calibration_length_m", "stop_sensor_m", "target_deceleration_ms2")
FOLLOWER = ("speed_error_percent", "target_braking", *SENSOR_FIELDS)
