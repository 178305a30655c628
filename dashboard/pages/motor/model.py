"""What the page Motor asks for: controller, limits of the inverter, a detuned rotor resistance; and its results."""

from collections.abc import Mapping
from typing import Any

import param

from railjoule.core import Scenario
from railjoule.core.scenario.options import SimulationOptions
from railjoule.core.simulation.field_oriented import FieldOrientedRun, Ripple
from railjoule.core.studies.flux_sweep import FluxSweep
from railjoule.core.studies.table import StudyTable
from railjoule.dashboard.pages.motor.compute import Limits, LoopRivals, MachineMap, limit_changes, limits_of
from railjoule.dashboard.state.numbers import TypedInteger, TypedNumber, TypedParameters, core_bounds
from railjoule.dashboard.state.page_model import PageModel, result

# the fields begin with the defaults of the file's own keys
LOOP = SimulationOptions()
FLUXES = ("constant", "min_loss")
CRUISE_KMH = 44.0
"""Speed of the flux chart where a scenario is opened: of the cruise that Rawicki prints, 12.26 m/s."""
CONTROL_FIELDS = (
    "precompensator",
    "bandwidth_rads",
    "rotor_resistance_factor",
    "flux",
    "speed_noise_rads",
    "noise_seed",
    "max_phase_voltage_v",
    "max_current_a",
)
"""What a run depends on, besides its plan."""


class MotorModel(TypedParameters, PageModel):
    """The settings of the page and its results, in the units that it shows."""

    kept = (*CONTROL_FIELDS, "ripple_at_s", "cruise_speed_kmh")
    passing = ("studying", "no_machine")

    precompensator = param.Boolean(default=True, doc="Whether the reference leads by the lag of the loop.")
    bandwidth_rads = TypedNumber(
        "Bandwidth, rad/s", "rad/s", 1, default=LOOP.bandwidth_rads, **core_bounds(SimulationOptions, "bandwidth_rads")
    )
    rotor_resistance_factor = TypedNumber(
        "Assumed / true resistance", "", 2, default=LOOP.rotor_resistance_factor, bounds=(0.2, 5.0), doc="Of the rotor."
    )
    flux = param.Selector(default=LOOP.flux, objects=list(FLUXES), doc="How the rotor flux is chosen.")
    speed_noise_rads = TypedNumber("Speed noise, rad/s", "rad/s", 2, default=0.0, bounds=(0.0, 100.0))
    noise_seed = TypedInteger("Seed", default=LOOP.noise_seed, bounds=(0, 2**31), doc="Of the noise.")
    max_phase_voltage_v = TypedNumber("Phase voltage, V", "V", default=None, allow_None=True, bounds=(1.0, 1e5))
    max_current_a = TypedNumber("Current, A", "A", default=None, allow_None=True, bounds=(1.0, 1e5))
    ripple_at_s = TypedNumber(
        "Ripple at t, s", "s", 1, default=20.0, bounds=(0.0, 86_400.0), softbounds=(0, 100), step=0.5
    )

    cruise_speed_kmh = TypedNumber(
        "Cruise speed, km/h", "km/h", 1, default=CRUISE_KMH, bounds=(1.0, 500.0), softbounds=(1, 100), step=1
    )

    run = result(FieldOrientedRun, "The last good run.")
    rivals = result(LoopRivals, "Run to compare it with.")
    machine_map = result(MachineMap, "Efficiency and run.")
    ripple = result(Ripple, "Current under switched voltage.")
    flux_sweep = result(FluxSweep, "Cruise over the flux current.")
    detuning = result(StudyTable, "The study so far.")
    studying = param.Boolean(default=False, doc="Whether the study of detuning is under way.")
    study = param.Event(doc="Start that study.")
    stop_study = param.Event(doc="Stop it; results so far are kept.")
    no_machine = param.String(default="", doc="Why this scenario has no motor to show.")

    def take(self, scenario: Scenario) -> None:
        """Take over what a scenario's file says of controller and machine."""
        options, limits = scenario.simulation, limits_of(scenario)
        self._scenario = scenario
        self.param.update(
            precompensator=options.precompensator,
            bandwidth_rads=options.bandwidth_rads,
            rotor_resistance_factor=options.rotor_resistance_factor,
            flux=options.flux,
            speed_noise_rads=options.speed_noise_rads,
            noise_seed=options.noise_seed,
            max_phase_voltage_v=None if limits is None else limits.max_phase_voltage_v,
            max_current_a=None if limits is None else limits.max_current_a,
            cruise_speed_kmh=min(CRUISE_KMH, scenario.vehicle.traction.max_speed_kmh),
        )

    @property
    def changes(self) -> Mapping[str, Any]:
        """Controller and limits, by the keys of the file."""
        return {
            "simulation.kind": "field_oriented",
            "simulation.precompensator": self.precompensator,
            "simulation.bandwidth_rads": float(self.bandwidth_rads),
            "simulation.rotor_resistance_factor": float(self.rotor_resistance_factor),
            "simulation.flux": self.flux,
            "simulation.speed_noise_rads": float(self.speed_noise_rads),
            "simulation.noise_seed": int(self.noise_seed),
            **self._limits(),
        }

    def _limits(self) -> Mapping[str, float]:
        """Return the limits of the inverter, where there is one."""
        if self.max_phase_voltage_v is None or self.max_current_a is None:
            return {}
        return limit_changes(self._scenario, Limits(float(self.max_phase_voltage_v), float(self.max_current_a)))
