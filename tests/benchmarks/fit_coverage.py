"""Shares of true parameters inside the intervals of 95 % of `railjoule.core.fit`, over random trains.

    python -m tests.benchmarks.fit_coverage [TRAINS]

Each case records four runs of each of TRAINS random trains (31 by default) by `tests.measured_trains` with one kind of
error of measurement, and fits them from the scenario `liashenko-ii`.
"""

import sys
from collections.abc import Sequence

import numpy as np

from railjoule.core import load_scenario
from railjoule.core.fit import Fit, fit_runs
from railjoule.core.fit.parameters import DEFAULT
from tests.measured_trains import CASES, SCENARIO, MeasuredTrain, measured_trains


def shares_inside(trains: Sequence[MeasuredTrain], fits: Sequence[Fit]) -> dict[str, float]:
    """Return the share of intervals that hold the truth, by the names of the parameters."""
    inside = [
        [one.low <= train.truth[one.name] <= one.high for one in fit.parameters]
        for train, fit in zip(trains, fits, strict=True)
    ]
    return dict(zip(DEFAULT, np.mean(inside, axis=0).tolist(), strict=True))


def main() -> None:
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 31
    scenario = load_scenario(SCENARIO)
    print(f"{count} trains a case; shares of truths inside the interval of 95 % [%]\n")
    print(f"{'case':30}" + "".join(f"{name.rpartition('.')[2]:>24}" for name in DEFAULT))
    for number, (case, errors) in enumerate(CASES.items()):
        trains = measured_trains(errors, count, seed=number)
        fits = [fit_runs(train.runs(scenario), scenario) for train in trains]
        shares = shares_inside(trains, fits)
        print(f"{case:30}" + "".join(f"{100 * shares[name]:24.0f}" for name in DEFAULT), flush=True)


if __name__ == "__main__":
    main()
