"""The runs of every strategy over scenarios of every drive keep every rule."""

import importlib.util
import warnings
from collections import Counter
from pathlib import Path
from types import ModuleType

import pytest

from railjoule.core import check_run
from railjoule.core.strategies import STRATEGIES
from tests.any_scenarios import MODELS, any_document
from tests.core.check.any_runs import SEEDS, any_runs, clear_faults

BATCH = 15
LITERAL = 12
"""The one seed of the gate whose set speeds are searched with the literal regulator, which takes seconds."""
GATE = [seed for seed in range(24) if seed == LITERAL or any_document(seed)["search"]["regulator"] != "literal"]
"""Of every drive two scenarios and more; the night looks at all."""
BATCHES = {"gate": GATE} | {f"from {first}": range(first, first + BATCH) for first in range(0, SEEDS, BATCH)}
REFERENCE = Path(__file__).parents[4] / "shared" / "check" / "check.py"
REFERENCE_SEEDS = [seed for seed in range(1, SEEDS, 13) if any_document(seed)["search"]["regulator"] != "literal"]
"""Over all drives."""
seen: Counter[tuple[str, str]] = Counter()


@pytest.mark.parametrize(
    "batch", [pytest.param(name, marks=[pytest.mark.nightly][: name != "gate"]) for name in BATCHES]
)
def test_runs_keep_every_rule(batch):
    faults = []
    for seed in BATCHES[batch]:
        for run in any_runs(seed):
            seen[run.strategy, run.scenario.vehicle.drive.model] += 1
            faults += [
                f"seed {seed}, {run.strategy}: {check.name}, {check.largest:.2g} of {check.allowed:.2g}"
                for check in clear_faults(check_run(run.scenario, run).checks)
            ]
    assert not faults


def test_every_strategy_has_driven_every_drive():
    if not seen:
        pytest.skip("needs the test before, in one process")
    copper_only = {"eoc", "enoc"}
    missing = [
        (name, model)
        for name in STRATEGIES
        for model in MODELS
        if not seen[name, model] and not (name in copper_only and model != "copper_loss")
    ]
    assert not missing


@pytest.fixture(scope="module")
def reference() -> ModuleType:
    """Return the independent checker of the review, which shares no code with ours."""
    if not REFERENCE.is_file():
        pytest.skip("the review's checker is not beside the repository (shared/check/check.py)")
    spec = importlib.util.spec_from_file_location("reference_check", REFERENCE)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class FormerNames:
    """A run under the names that the review's checker reads."""

    NAMES = {"line_energy_j": "supply_energy_j", "line_power_w": "supply_power_w"}  # noqa: RUF012

    def __init__(self, run):
        self.run = run

    def __getattr__(self, name):
        return getattr(self.run, self.NAMES.get(name, name))


WITHOUT_PRICE = "early"
"""The reference calls every early arrival so, ours only one that costs something."""


def test_what_the_reference_finds_ours_finds_too(reference):
    missed, alone = [], []
    for seed in REFERENCE_SEEDS:
        for run in any_runs(seed):
            document = run.scenario.model_dump(mode="json", exclude_none=True)
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", RuntimeWarning)
                faults = [
                    fault
                    for fault in reference.check(document, FormerNames(run), run.strategy)
                    if fault[0] != WITHOUT_PRICE
                ]
            ours = check_run(run.scenario, run).broken
            place = f"seed {seed}, {run.strategy}"
            if faults and not ours:
                missed.append(f"{place}: {faults}")
            if not faults and clear_faults(ours):
                alone.append(f"{place}: {ours}")
    assert not missed
    assert not alone
