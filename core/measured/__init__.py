"""Measured runs: a recorder's file becomes a trajectory over the line of a scenario, beside its optimum.

Read `table` first, which reads a file's columns, then `recording`, which checks it row by row, then `place`, which
finds where on the line it lies, then `run`; `run_table` makes a plain table of it.
"""

from railjoule.core.measured.columns import PRESETS, RecorderFormat
from railjoule.core.measured.recorded_table import RunTable, run_table
from railjoule.core.measured.recording import Recording, load_recording, read_recording, to_recording
from railjoule.core.measured.run import MeasuredRun, load_run, measured_run
from railjoule.core.measured.saving import Saving, possible_saving
from railjoule.core.measured.table import recorder_cells

__all__ = [
    "PRESETS",
    "MeasuredRun",
    "RecorderFormat",
    "Recording",
    "RunTable",
    "Saving",
    "load_recording",
    "load_run",
    "measured_run",
    "possible_saving",
    "read_recording",
    "recorder_cells",
    "run_table",
    "to_recording",
]
