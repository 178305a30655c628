"""Scenarios that once broke a solver or a strategy, found by random search; numbers are as found, or rounded."""

from typing import Any

WEAK_BRAKES: dict[str, Any] = {
    "title": "weak brakes",
    "vehicle": {
        "name": "found",
        "tare_kg": 44366.1844592125,
        "capacity_passengers": 341,
        "load_factor": 1.0,
        "rotating_mass_factor": 0.8182602787616935,
        "length_m": 26.4593214328599,
        "car_count": 6,
        "resistance": {
            "constant_n_per_kn": 2.5332226344872155,
            "linear_n_per_kn_per_kmh": 0.016397120428956878,
            "quadratic_n_per_kn_per_kmh2": 0.0007838088799114565,
            "constant_n": 277.08111400768297,
            "linear_n_per_kmh": 10.241521990168984,
            "quadratic_n_per_kmh2": 0.037195486720089765,
            "curve_constant_m_n_per_kn": 722.9765153129205,
            "car_kinds": [
                {
                    "cars": 1,
                    "constant_n_per_kn": 1.7732887297199695,
                    "quadratic_n_per_kn_per_kmh2": 4.317060790248417e-05,
                },
                {"cars": 5, "linear_n_per_kn_per_kmh": 0.005},
            ],
        },
        "traction": {
            "max_speed_kmh": 31.14755405917511,
            "max_effort_kn": 14.674056139316505,
            "max_power_kw": 41.26072228513323,
        },
        "braking": {"max_effort_kn": 79.06810173862823, "max_power_kw": 26.367592479278734},
        "drive": {
            "model": "constant_efficiency",
            "recuperation_factor": 0.0,
            "traction_efficiency": 0.6249453720894479,
            "braking_efficiency": 0.9014925522563701,
        },
    },
    "line": {
        "sections": [
            {"length_m": 234.40958040020826, "gradient_permille": -47.274599119497296},
            {
                "length_m": 20.533008596422775,
                "gradient_permille": -9.416551143066833,
                "speed_limit_kmh": 27.832607182564104,
                "tunnel_factor": 1.047442705161875,
            },
            {"length_m": 91.40720222269945, "gradient_permille": 28.439050088755522},
            {
                "length_m": 490.0070808205774,
                "gradient_permille": -13.748198961887404,
                "curve_radius_m": 2864.9018565892347,
            },
            {"length_m": 26.442875067020964, "gradient_permille": 18.16178988848158},
            {"length_m": 35.686709398717426, "gradient_permille": 0.0},
            {"length_m": 18.502192027867636, "gradient_permille": 0.0},
        ]
    },
    "timetable": {"travel_time_s": 407.83795376371256},
    "solver": {"mesh_m": 2.2615032524894834},
}
"""Brakes of 26 kW on a long descent: the fastest run brakes fully nearly everywhere, and nothing needs energy."""

COASTS_ALL_BUT_TO_A_STAND: dict[str, Any] = {
    "title": "coasts all but to a stand",
    "vehicle": {
        "name": "found",
        "tare_kg": 346189.76804094034,
        "capacity_passengers": 2662,
        "load_factor": 0.5,
        "rotating_mass_factor": 0.06936576560288019,
        "auxiliary_power_kw": 34.59552129487079,
        "resistance": {"constant_n_per_kn": 2.7798959528322893},
        "traction": {"max_speed_kmh": 333.58953007914886, "max_effort_kn": 294.6322035719911},
        "braking": {"max_effort_kn": 266.11910151489997, "max_power_kw": 9402.865099322},
        "drive": {
            "model": "copper_loss",
            "recuperation_factor": 0.6321125672291291,
            "motors": 2,
            "gear_ratio": 6.026894605645236,
            "wheel_diameter_m": 0.6564371240865304,
            "torque_per_amp_nm": 7.155331562299951,
            "resistance_ohm": 0.772254042563364,
        },
    },
    "line": {"sections": [{"length_m": 257.57330362202555, "gradient_permille": 13.638440732032322}]},
    "timetable": {"travel_time_s": 80.23870612543512},
    "solver": {"mesh_m": 36.72282813609372},
}
"""So much time that the best run in phases coasts until next to no speed is left to brake from."""
COMES_TO_REST_FOR_EVER: dict[str, Any] = {
    "title": "a train that comes to rest ever more slowly",
    "vehicle": {
        "name": "heavy tram",
        "tare_kg": 137e3,
        "capacity_passengers": 1050,
        "load_factor": 0.6,
        "rotating_mass_factor": 0.34,
        "resistance": {"constant_n_per_kn": 2.05, "constant_n": 548.0},
        "traction": {"max_speed_kmh": 37.3, "max_power_kw": 762.0},
        "braking": {"max_effort_kn": 84.4, "max_power_kw": 445.0},
        "drive": {
            "model": "induction",
            "motors": 98,
            "gear_ratio": 8.33,
            "wheel_diameter_m": 0.663,
            "gear_efficiency": 0.996,
            "pole_pairs": 2,
            "stator_resistance_ohm": 0.117,
            "rotor_resistance_ohm": 0.14,
            "stator_inductance_mh": 33.1,
            "rotor_inductance_mh": 33.9,
            "mutual_inductance_mh": 32.5,
            "rated_magnetising_current_a": 29.3,
            "rated_frequency_hz": 60.0,
            "hysteresis_loss_w": 283.0,
            "eddy_loss_w": 303.0,
            "mechanical_loss_torque_nm": 5.05,
            "max_phase_voltage_v": 410.0,
            "starting_current_a": 180.0,
            "braking_current_a": 198.0,
            "recuperation_factor": 0.5,
        },
    },
    "line": {
        "reverse": True,
        "sections": [
            {"length_m": 30.3, "gradient_permille": 48.7},
            {"length_m": 12.8, "gradient_permille": 0.0},
            {"length_m": 49.2, "gradient_permille": 6.91},
        ],
    },
    "search": {"regulator": "literal", "limits_kmh": [2.608, 2.608, 2.461]},
    "timetable": {"travel_time_s": 220.0},
}
"""The printed regulator brakes it ever more slowly without ever holding it: 1e-13 m/s moves no place any more."""
