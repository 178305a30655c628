"""Simulations of a plan under actual conditions: load, position errors, events, motor control, manual driving."""
