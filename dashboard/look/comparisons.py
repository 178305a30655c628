"""How runs compare, in words: with the best known run, with a bound, with another run, with the time asked for.

A page's numbers and tables, a report and the command line all call this module. The reference of a run is
decided in `railjoule.core.best_known`, and when a share of an energy means anything in
`railjoule.core.energy.share_above`.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from railjoule.core import Trajectory
from railjoule.core.arrays import FloatArray
from railjoule.core.energy import share_above
from railjoule.core.lower_bound import Reference
from railjoule.dashboard.look import words

# half of the tenth in which times are shown
OTHER_TIME_S = 0.05
"""From this difference on, a time reads differently."""
# shown with one decimal, a smaller one would read 0.0 m
MIN_SHOWN_STOP_ERROR_M = 0.05
"""From this stopping error on, a run misses its stop."""
MISSED = "Runs that say late, beyond or short need less energy, but arrive late or miss the stop: that saves nothing."
"""Meaning of the words of `extra_cell`."""
STANDS = "stands"
"""A cell of a run that does not reach the end."""
WAITING = "more time saves nothing"
# the least that a percentage of two decimals can tell
MIN_SHOWN_GAP = 1e-4
"""A gap reads as this at least, never as none."""


class Amount(NamedTuple):
    """By how much one energy exceeds another: a share, or the difference where a share would mean nothing."""

    value: str
    unit: str

    def __str__(self) -> str:
        return f"{self.value} {self.unit}"

    @property
    def cell(self) -> str:
        """The amount under a heading in %."""
        return self.value if self.unit == "%" else str(self)

    @property
    def sentence(self) -> str:
        """The amount as in '5.8 % above'."""
        return f"{self.size} {self.unit} {'below' if self.is_less else 'above'}"

    @property
    def size(self) -> str:
        """The amount without its sign."""
        return self.value.lstrip(f"+{words.MINUS}")

    @property
    def is_less(self) -> bool:
        """Whether the energy lies below the other."""
        return self.value.startswith(words.MINUS)

    @property
    def is_none(self) -> bool:
        """Whether it reads as no difference at all."""
        return not any(character in "123456789" for character in self.value)


NOTHING = Amount(words.share_difference(0.0), "%")


def above(energy_kwh: float, reference_kwh: float) -> Amount:
    """Return by how much an energy [kWh] lies above another: in percent, or in kWh where that is no measure."""
    share = share_above(energy_kwh, reference_kwh)
    if math.isfinite(share):
        return Amount(words.share_difference(share), "%")
    return Amount(words.energy_difference(energy_kwh - reference_kwh), "kWh")


def misses(delay_s: float, stop_error_m: float) -> tuple[Amount, ...]:
    """Return how far an actual run misses timetable and stop, as '3.2 s late' and '14.5 m beyond the stop'."""
    missed = []
    if delay_s >= OTHER_TIME_S:
        missed.append(Amount(words.time(delay_s), "s late"))
    if abs(stop_error_m) >= MIN_SHOWN_STOP_ERROR_M:
        side = "beyond the stop" if stop_error_m > 0 else "short of the stop"
        missed.append(Amount(words.number(abs(stop_error_m)), f"m {side}"))
    return tuple(missed)


def is_false_saving(
    energy_kwh: float | FloatArray,
    reference_kwh: float | FloatArray,
    delay_s: float | FloatArray,
    stop_error_m: float | FloatArray,
) -> Any:
    """Return whether a run needs less energy than another [kWh], but misses timetable or stop; of arrays an array."""
    misses_stop = np.abs(stop_error_m) >= MIN_SHOWN_STOP_ERROR_M
    return (energy_kwh < reference_kwh) & ((delay_s >= OTHER_TIME_S) | misses_stop)


def extra(energy_kwh: float, reference_kwh: float, delay_s: float, stop_error_m: float) -> Amount:
    """Return as `above` by how much an actual run lies above another; never a percentage saved by a miss."""
    if is_false_saving(energy_kwh, reference_kwh, delay_s, stop_error_m):
        return Amount(words.energy_difference(energy_kwh - reference_kwh), "kWh")
    return above(energy_kwh, reference_kwh)


def headline(
    energy_kwh: float, reference_kwh: float, delay_s: float, stop_error_m: float, detail: str
) -> tuple[Amount, str]:
    """Return the main number of an actual run and the text below it: a missed stop comes before less energy."""
    if not is_false_saving(energy_kwh, reference_kwh, delay_s, stop_error_m):
        return above(energy_kwh, reference_kwh), detail
    first, *others = misses(delay_s, stop_error_m)
    return first, "; ".join([*map(str, others), detail])


def extra_cell(energy_kwh: float, reference_kwh: float, delay_s: float, stop_error_m: float) -> str:
    """Return `extra` under a heading in %, where a missed stop has the room of one word."""
    if not math.isfinite(energy_kwh):
        return STANDS
    if is_false_saving(energy_kwh, reference_kwh, delay_s, stop_error_m):
        return "late" if delay_s >= OTHER_TIME_S else "beyond" if stop_error_m > 0 else "short"
    return above(energy_kwh, reference_kwh).cell


def outcome(energy_kwh: float, planned_kwh: float, delay_s: float, stop_error_m: float) -> str:
    """Return in a sentence what became of a plan; what was missed comes before energy that this saves."""
    more = extra(energy_kwh, planned_kwh, delay_s, stop_error_m)
    if is_false_saving(energy_kwh, planned_kwh, delay_s, stop_error_m):
        return f"{', '.join(map(str, misses(delay_s, stop_error_m)))}; {more} energy."
    return f"{more} energy, {words.delay(delay_s)} s, stopping error {words.stop_error(stop_error_m)} m."


def saving(energy_kwh: float, reference_kwh: float) -> tuple[str, Amount]:
    """Return whether a run 'saves' or 'costs' energy [kWh] beside another, and how much of the other's, unsigned."""
    amount = above(energy_kwh, reference_kwh)
    return "costs" if not amount.is_less and not amount.is_none else "saves", Amount(amount.size, amount.unit)


def above_reference(run: Trajectory) -> Amount | None:
    """Return by how much a run lies above the best known one; None where none was looked for."""
    return None if run.reference is None else above(run.energy_kwh, run.reference.energy_kwh)


def late(travel_time_s: float, asked_s: float) -> str:
    """Return how late a run is, as '1.7 s late'; empty where it is in time."""
    more = travel_time_s - asked_s
    return f"{words.time(more)} s late" if more >= OTHER_TIME_S else ""


def early(travel_time_s: float, asked_s: float) -> str:
    """Return how early a run is, as '36.4 s early'; empty where it is not."""
    less = asked_s - travel_time_s
    return f"{words.time(less)} s early" if less >= OTHER_TIME_S else ""


def delay_words(run: Trajectory) -> str:
    """Return how late a run arrives by its timetable; empty where it is in time."""
    return late(run.travel_time_s, run.scenario.travel_time_s)


def off_time(run: Trajectory) -> str:
    """Return how late or early a run arrives by its timetable; empty where it is in time, or the best known itself."""
    return delay_words(run) or ("" if is_reference(run) else early(run.travel_time_s, run.scenario.travel_time_s))


def in_time_asked(run: Trajectory) -> str:
    """Return by how much a run lies above the best known one in the time of the timetable, or how late or early it is.

    It stands under a heading in %. A run in another time has no percentage: time and energy trade.
    """
    return off_time(run) or cell(above_reference(run))


def beside(run: Trajectory, other: Trajectory) -> str:
    """Return by how much a run lies above another, or how late or early it is where it keeps neither time.

    It stands under a heading in %.
    """
    same = abs(run.travel_time_s - other.travel_time_s) < OTHER_TIME_S
    off = "" if same else off_time(run)
    return off or cell(above(run.energy_kwh, other.energy_kwh))


def above_bound(energy_kwh: float, bound_kwh: float | None, gap: float | None) -> Amount | None:
    """Return by how much an energy lies above its bound; None where no bound is known.

    Parameters
    ----------
    energy_kwh, bound_kwh : float
        Energy and bound [kWh].
    gap
        As `Trajectory.gap` has it.
    """
    if bound_kwh is None or gap is None:
        return None
    if 0 < gap < MIN_SHOWN_GAP:
        return Amount(words.share_difference(MIN_SHOWN_GAP), "%")
    return above(energy_kwh, bound_kwh)


def above_own_bound(run: Trajectory) -> Amount | None:
    """Return by how much a run lies above its bound."""
    return above_bound(run.energy_kwh, run.lower_bound_kwh, run.gap)


def cell(amount: Amount | None) -> str:
    """Return an amount under a heading in %; a dash where there is none."""
    return words.UNKNOWN if amount is None else amount.cell


def is_reference(run: Trajectory) -> bool:
    """Return whether a run is itself the best known one."""
    reference = run.reference
    # exactly equal, as the reference has its energy from that very run
    return reference is not None and reference.strategy == run.strategy and reference.energy_j == run.energy.net_j


def reference_name(proven: bool) -> str:
    """Return the name of the reference at the head of a column: the optimum only where proven."""
    return "optimum" if proven else "best known"


def reference_noun(proven: bool) -> str:
    """Return the same within a sentence."""
    return "optimum" if proven else "best known run"


def reference_words(reference: Reference, asked_s: float) -> str:
    """Return a reference within a sentence, as 'optimum of 4.144 kWh in 303.0 s' for a run with a time of its own."""
    who = "" if reference.strategy == "optimal" else f" ({words.strategy(reference.strategy)})"
    return f"{reference_noun(reference.proven)}{who} of {_energy_and_time(reference, asked_s)}"


def reference_detail(run: Trajectory) -> str:
    """Return the text below a distance to the reference: the optimum, or the bound where none is proven."""
    reference, bound_kwh = run.reference, run.lower_bound_kwh
    if reference is None:
        return ""
    if reference.proven or bound_kwh is None:
        return f"{reference_name(reference.proven)} {words.energy(reference.energy_kwh)} kWh"
    return f"bound {words.energy(bound_kwh)} kWh"


def _energy_and_time(reference: Reference, asked_s: float) -> str:
    time = "" if abs(reference.within_s - asked_s) < OTHER_TIME_S else f" in {words.time(reference.within_s)} s"
    return f"{words.energy(reference.energy_kwh)} kWh{time}"


def printed_difference(percent: float | None, points: float | None) -> str:
    """Return the difference of railjoule's number from a printed one, as `Row` has it; percentages differ by points."""
    if points is not None:
        return f"{words.share_difference(points / 100)} pp"
    return "" if percent is None else f"{words.share_difference(percent / 100)} %"


def arrival(later_s: float) -> str:
    """Return how much later a run arrives than another [s], in words."""
    if abs(later_s) < OTHER_TIME_S:
        return "at the same time"
    return f"{words.time(abs(later_s))} s {'later' if later_s > 0 else 'earlier'}"


def other_time(strategy: str, travel_time_s: float, asked_s: float) -> str:
    """Return by how much a run takes another time than asked, in a few words; empty if it does not."""
    more = travel_time_s - asked_s
    if abs(more) < OTHER_TIME_S:
        return ""
    if more > 0:
        return f"{words.time(more)} s later than the timetable\u2019s {words.time(asked_s)} s"
    early = f"{words.time(-more)} s earlier than the timetable\u2019s {words.time(asked_s)} s"
    return f"{early}: {WAITING}" if strategy == "optimal" else early


def time_asked(run: Trajectory) -> str:
    """Return the time asked for where a run takes another one, below a number; empty where it does not."""
    return f"timetable {words.time(run.scenario.travel_time_s)} s" if other_time_of(run) else ""


def waiting_words(run: Trajectory) -> str:
    """Return why an optimum takes less time than asked, in four words; empty where it does not."""
    return WAITING if WAITING in other_time_of(run) else ""


def other_time_of(run: Trajectory) -> str:
    """Return by how much a run takes another time than its scenario asks."""
    return other_time(run.strategy, run.travel_time_s, run.scenario.travel_time_s)
