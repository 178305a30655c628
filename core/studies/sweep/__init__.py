"""A sweep: very many runs of one scenario whose numbers vary, as one table.

Solving each run separately would check a scenario, a line and a run every time. Here the scenario is checked once, at
the corners of the box that its ranges span (`fields`). A run then replaces numbers, rebuilds only the parts of the
mesh that depend on them, and is solved and certified in compiled code that releases the lock of Python (`engine`).
All of this uses the functions of `solve`, so that a row equals its result to the last bit. Runs that cannot be made
this way go through `solve` itself, which is slower.

A row depends only on its number and the seed (`fields`), so that neither the order of the runs nor the number of
workers changes a table. `study` describes the task, `running` computes it on any executor chunk by chunk, and
`results` saves the rows in memory or in a file that outlives the process. `table_files` writes and reads tables, and
`sobol` finds the fields that decide a column. `sweep` does all of it in one call.
"""

from railjoule.core.studies.sweep.fields import METHODS, Method
from railjoule.core.studies.sweep.results import MemoryResults, StudyFileError, SweepFile, SweepTable
from railjoule.core.studies.sweep.running import InterruptedStudyError, run_study, sweep
from railjoule.core.studies.sweep.sobol import SensitivityError, sensitivities
from railjoule.core.studies.sweep.study import COLUMNS, DEFAULT_COLUMNS, Study, make_study
from railjoule.core.studies.sweep.table_files import write_rows

__all__ = [
    "COLUMNS",
    "DEFAULT_COLUMNS",
    "METHODS",
    "InterruptedStudyError",
    "MemoryResults",
    "Method",
    "SensitivityError",
    "Study",
    "StudyFileError",
    "SweepFile",
    "SweepTable",
    "make_study",
    "run_study",
    "sensitivities",
    "sweep",
    "write_rows",
]
