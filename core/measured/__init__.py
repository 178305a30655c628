"""Measured runs: a recorder's file becomes a trajectory over the line of a scenario, beside its optimum.

Read `recording` first, which checks a file row by row, then `place`, which finds where on the line it lies, then `run`.
"""

from railjoule.core.measured.columns import PRESETS, RecorderFormat
from railjoule.core.measured.recording import Recording, load_recording, read_recording
from railjoule.core.measured.run import MeasuredRun, load_run, measured_run
from railjoule.core.measured.saving import Saving, possible_saving

__all__ = [
    "PRESETS",
    "MeasuredRun",
    "RecorderFormat",
    "Recording",
    "Saving",
    "load_recording",
    "load_run",
    "measured_run",
    "possible_saving",
    "read_recording",
]
