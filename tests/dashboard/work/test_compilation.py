"""What pages do while the solver is being compiled, and after."""

import os
import subprocess
import sys

import pytest

EVERY_STRATEGY = """
from numba.core import event

from railjoule.core import compare, load_scenario
from railjoule.core.advice import advise
from railjoule.core.compilation import require_compiled
from railjoule.core.scenario import preset_names
from railjoule.core.simulation.field_oriented import current_ripple, simulate_field_oriented
from railjoule.core.studies.motor_map import induction_map, motor_map
from railjoule.dashboard.pages.set_speeds.compute import (
    compute_limit_run,
    compute_limit_trip,
    compute_storage,
)
from railjoule.dashboard.pages.trade_off.compute import compute_trade_off

compiled = []


class Note(event.Listener):
    def on_start(self, _event):
        pass

    def on_end(self, one):
        compiled.append(one.data["dispatcher"].py_func.__qualname__)


require_compiled()
with event.install_listener("numba:compile", Note()):
    for name in preset_names("scenarios"):
        for run in compare(load_scenario(name)).runs:
            advise(run)
        compute_trade_off(load_scenario(name), 400.0, False, 1.0)
    machine = load_scenario("ftorek-300s")
    driven = simulate_field_oriented(machine)
    advise(driven.actual)
    current_ripple(driven, 100.0)
    induction_map(machine)
    metro = load_scenario("kharkiv-like-20kmh")
    motor_map(metro)
    for regulator in ("coast", "brake", "literal"):
        changes = {"search.regulator": regulator, "search.limits_kmh": [40.0, 30.0]}
        compute_limit_trip(metro, changes)
        compute_storage(compute_limit_run(metro, changes), None, None, 0.95, 0.95)
print(compiled)
"""

COLD_PAGES = """
import gc

from numba.core.dispatcher import Dispatcher

from railjoule.core.compilation import Compilation
from railjoule.dashboard.page_list import PAGES

# another process compiles, and never ends
Compilation._run = lambda self: None

from railjoule.dashboard.app import Session

session = Session()
session._load()
print(session.state.runs.best.energy_kwh)
for page in PAGES:
    session.state.page = page
session.state.page = "Start"
session.browser._handle_msg({"kind": "scenario", "name": "tram-950m"})
session.state.scenario.load_percent = 50.0
kernels = [one for one in gc.get_objects() if isinstance(one, Dispatcher) and one.__module__.startswith("railjoule")]
print(sum(len(one.signatures) for one in kernels), session.shell.compiling is not None)
"""


@pytest.mark.nightly
def test_nothing_is_left_to_compile_after_the_compilation() -> None:
    result = subprocess.run([sys.executable, "-c", EVERY_STRATEGY], capture_output=True, text=True, check=True)
    assert result.stdout.strip() == "[]"


def test_a_page_opens_with_its_first_run_while_nothing_is_compiled(tmp_path) -> None:
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
    command = [sys.executable, "-W", "ignore", "-c", COLD_PAGES]
    result = subprocess.run(command, capture_output=True, text=True, check=True, env=environment)
    energy, *rest = result.stdout.split()
    # as tests/core/test_goldens.py has it of metro-with-limit
    assert float(energy) == pytest.approx(7.813754, rel=1e-6)
    assert rest == ["0", "True"]
