"""Induction machines under field-oriented control that follow a plan in closed loop."""

from railjoule.core.simulation.field_oriented.pwm import Ripple, current_ripple
from railjoule.core.simulation.field_oriented.run import FieldOrientedRun, Saturation
from railjoule.core.simulation.field_oriented.simulation import simulate_field_oriented

__all__ = ["FieldOrientedRun", "Ripple", "Saturation", "current_ripple", "simulate_field_oriented"]
