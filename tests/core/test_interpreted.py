"""All shipped runs of smooth drives, computed without a compiler."""

import json
import os
import subprocess
import sys

import pytest

from railjoule.core import load_scenario, solve
from railjoule.core.compilation.light import NO_IDLE_LOSSES, estimated_cells
from railjoule.core.scenario import preset_names

MAX_CELLS = 1100
"""Of lines that Python alone solves within some seconds."""
SOLVE = """
import json, sys
from railjoule.core import load_scenario, solve
runs = {name: solve(load_scenario(name)) for name in sys.argv[1:]}
print(json.dumps({name: [float(run.energy_kwh), float(run.gap)] for name, run in runs.items()}))
"""


def is_smooth_and_short(name):
    scenario = load_scenario(name)
    smooth = isinstance(scenario.vehicle.drive, NO_IDLE_LOSSES) and scenario.strategy in {"optimal", "fastest"}
    return smooth and estimated_cells(scenario) < MAX_CELLS


@pytest.mark.nightly
def test_without_the_compiler_energies_and_gaps_are_those_of_compiled_kernels():
    """With NUMBA_DISABLE_JIT: no kernel may need the division by zero or the indices of compiled code."""
    names = [name for name in preset_names("scenarios") if is_smooth_and_short(name)]
    assert len(names) >= 5
    command = [sys.executable, "-W", "error", "-c", SOLVE, *names]
    environment = {**os.environ, "NUMBA_DISABLE_JIT": "1"}
    process = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert process.returncode == 0, process.stderr
    for name, (energy, gap) in json.loads(process.stdout).items():
        run = solve(load_scenario(name))
        assert energy == pytest.approx(run.energy_kwh, rel=1e-12), name
        assert gap == pytest.approx(run.gap, abs=1e-9), name
