import subprocess
import sys

from railjoule.dashboard.warmup import Warmup, all_kernels

EVERY_STRATEGY = """
from railjoule.core import compare, load_scenario
from railjoule.core.advice import advise
from railjoule.core.scenario import preset_names
from railjoule.core.simulate.field_oriented import current_ripple, simulate_field_oriented
from railjoule.core.studies.induction_map import induction_map
from railjoule.core.studies.motor_map import motor_map
from railjoule.dashboard.store import (
    LimitsRequest,
    StorageRequest,
    TradeOffRequest,
    compute_limit_run,
    compute_limit_trip,
    compute_storage,
    compute_trade_off,
)
from railjoule.dashboard.warmup import all_kernels, warmup

def compiled():
    return {kernel.py_func.__qualname__: len(kernel.signatures) for kernel in all_kernels()}

warmup().start()
assert warmup().ready.wait(240)
before = compiled()
for name in preset_names("scenarios"):
    for run in compare(load_scenario(name))[0]:
        advise(run)
    compute_trade_off(TradeOffRequest(load_scenario(name), 400.0, False, 1.0))
machine = load_scenario("ftorek-300s")
driven = simulate_field_oriented(machine)
advise(driven.actual)
current_ripple(driven, 100.0)
induction_map(machine)
metro = load_scenario("kharkiv-like-20kmh")
motor_map(metro)
for regulator in ("coast", "brake", "literal"):
    request = LimitsRequest(metro, {"search.regulator": regulator, "search.limits_kmh": [40.0, 30.0]})
    compute_limit_trip(request)
    compute_storage(StorageRequest(compute_limit_run(request), None, None, 0.95, 0.95))
after = compiled()
print({name: count for name, count in after.items() if count != before.get(name)})
"""


def test_nothing_is_left_to_compile_after_the_warm_up() -> None:
    result = subprocess.run([sys.executable, "-c", EVERY_STRATEGY], capture_output=True, text=True, check=True)
    assert result.stdout.strip() == "{}"


def test_progress_counts_kernels() -> None:
    done, count = Warmup().progress
    assert 0 <= done <= count
    assert count == len(list(all_kernels())) > 10
