"""The verdict on a try: its comparison with the best run, for the browser and in sentences."""

from collections.abc import Mapping
from dataclasses import dataclass
from dataclasses import field as declared
from typing import Any

import numpy as np

from railjoule.core import Trajectory
from railjoule.core.arrays import FloatArray
from railjoule.core.units import J_PER_KWH, MS_PER_KMH

BEYOND = {"losses": "Lost in motors and brakes", "resistance": "Lost to resistance", "auxiliary": "Auxiliaries"}
"""Words for the energies that a run dissipates."""
FASTER, MORE = ("faster", "slower"), ("more", "less")
"""Words of a difference of speed and of energy that is not negative, and of one that is."""
# a second behind the decimal point is rounding of the last cells
IN_TIME_S = 0.05


@dataclass(frozen=True, eq=False)
class Verdict:
    """How something that was played compares with the best.

    Parameters
    ----------
    field, text : str
        The field of the page that holds what was played, and its text.
    kwh, bound_kwh : float
        Its energy, and the proven lower bound.
    proven : bool
        Whether the best run reaches the bound.
    time_s, allowed_s, late_s : float
        Its time, the time that the bound is for, and its delay against the timetable.
    curves : mapping
        Curves for the browser.
    driven : tuple of array or None
        Places [m] and speeds [km/h] of a run.
    sentences : tuple of str
    rows : tuple
        Extra energy against the best, by where it goes [kWh].
    """

    field: str
    text: str
    kwh: float
    bound_kwh: float
    proven: bool
    time_s: float = 0.0
    allowed_s: float = 0.0
    late_s: float = 0.0
    curves: Mapping[str, Any] = declared(default_factory=dict)
    driven: tuple[FloatArray, FloatArray] | None = None
    sentences: tuple[str, ...] = ()
    rows: tuple[tuple[str, float], ...] = ()

    @property
    def counts(self) -> bool:
        """Whether it is on time."""
        return self.late_s <= IN_TIME_S

    @property
    def share(self) -> float:
        """By how much it lies above the bound, as a share of that."""
        return self.kwh / self.bound_kwh - 1


def compare(
    played: tuple[str, str], run: Trajectory, best: Trajectory, asked_s: float, sentences: tuple[str, ...], **more: Any
) -> Verdict:
    """Compare a run with the best one.

    Parameters
    ----------
    played : tuple of str
        Field and text.
    run, best : Trajectory
    asked_s : float
        The time of the timetable [s].
    sentences : tuple of str
    **more
        Further things for the browser to draw.
    """
    bound = best.bound
    assert bound is not None
    # the optimum may have a finer mesh; within a cell the square of speed is linear
    places = run.position_m
    best_j, best_s = (np.interp(places, best.position_m, one) for one in (best.supply_energy_j, best.time_s))
    curves = {
        "best_ms": np.sqrt(np.interp(places, best.position_m, best.speed_ms**2)).tolist(),
        "best_s": best_s.tolist(),
        "above_kwh": ((run.supply_energy_j - best_j) / J_PER_KWH).tolist(),
        **more,
    }
    return Verdict(
        *played,
        kwh=run.energy_kwh,
        bound_kwh=bound.energy_j / J_PER_KWH,
        proven=best.is_proven,
        time_s=run.travel_time_s,
        allowed_s=best.scenario.travel_time_s,
        late_s=run.travel_time_s - asked_s,
        curves=curves,
        driven=(places, run.speed_ms / MS_PER_KMH),
        sentences=sentences,
        rows=beyond(run, best),
    )


def beyond(run: Trajectory, best: Trajectory) -> tuple[tuple[str, float], ...]:
    """Return the extra energy of a run against the best, by where it goes [kWh]; the parts sum to the whole."""
    mine, least = _spent_kwh(run), _spent_kwh(best)
    rows = ((word, mine[name] - least[name]) for name, word in BEYOND.items())
    # a train without auxiliaries has no row of them
    return tuple(row for row in rows if row[1] or row[0] != BEYOND["auxiliary"])


def _spent_kwh(run: Trajectory) -> dict[str, float]:
    energy = run.energy
    spent = {
        "losses": sum(energy.losses_j.values()),
        "resistance": energy.running_resistance_j + energy.curve_resistance_j,
        "auxiliary": energy.auxiliary_j,
    }
    return {name: joules / J_PER_KWH for name, joules in spent.items()}
