"""A sweep: very many runs of one scenario whose numbers vary, as one table.

A study of one run each validates a scenario, a course and a trajectory anew. Here a scenario is validated once, at the
corners of the box over which its fields vary (`fields`); a run then patches numbers, makes what they touch of a course
again, and solves and certifies it in compiled code that lets other threads go on (`engine`). All of it goes through the
functions that `solve` itself uses, so that a row is the same to the last bit. What cannot be patched goes the ordinary
way, by `solve`, and is as right, only slower.

A row depends on its number and the seed alone (`sampling`), so that neither the order of the runs nor the number of
workers changes a table. `study` says what is to be made; `running` has it made by any executor, chunk by chunk, and
keeps the rows in memory (`results`) or in a file that outlives the process (`file`), from which `export` writes tables
and `sensitivities` tells which field decides. `cluster` finds workers elsewhere. `sweep` in `table` is the short way.
"""

from railjoule.core.studies.sweep.columns import COLUMNS, DEFAULT_COLUMNS
from railjoule.core.studies.sweep.export import ExportError, write_rows
from railjoule.core.studies.sweep.file import StudyFileError, SweepFile
from railjoule.core.studies.sweep.results import MemoryResults, Results, SweepTable, table_of
from railjoule.core.studies.sweep.running import InterruptedStudyError, run_study
from railjoule.core.studies.sweep.sampling import METHODS, Method
from railjoule.core.studies.sweep.sobol import Sensitivities, SensitivityError, sensitivities
from railjoule.core.studies.sweep.study import Study, study_of
from railjoule.core.studies.sweep.table import sweep

__all__ = [
    "COLUMNS",
    "DEFAULT_COLUMNS",
    "METHODS",
    "ExportError",
    "InterruptedStudyError",
    "MemoryResults",
    "Method",
    "Results",
    "Sensitivities",
    "SensitivityError",
    "Study",
    "StudyFileError",
    "SweepFile",
    "SweepTable",
    "run_study",
    "sensitivities",
    "study_of",
    "sweep",
    "table_of",
    "write_rows",
]
