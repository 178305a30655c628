"""Calibration errors of a recorder's gauges: gain and offset of effort and power, gain of speed.

A calibration error is one unknown number for all samples. Residuals hardly show it, because other parameters take its
place: a gain of the effort is a smaller mass, an offset of the power is an auxiliary power. So each is a parameter of
the fit beside those of the train (a nuisance parameter), normally distributed around zero with a stated deviation.
"""

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields

from railjoule.core.errors import RecordingError

MAX_PERCENT = 50.0
"""A gauge with a larger deviation measures nothing."""


@dataclass(frozen=True)
class GaugeErrors:
    """Standard deviations of the calibration errors [%].

    The defaults are assumptions: efforts are mostly computed from motor currents, for which makers state 1 to 3 %, and
    meters of the power of class 1 or 1.5. 0 takes a gauge as exact.

    Parameters
    ----------
    effort_gain : float
        Of a factor on all efforts.
    effort_offset : float
        Of what is added to all efforts that are not zero, over the largest one.
    power_gain : float
        Of a factor on all powers.
    power_offset : float
        Of what is added to all powers, over the largest one.
    speed_gain : float
        Of a factor on the speeds of runs that do not lie between two stations: where a run begins and ends at rest in
        a station, the distance between them gives the factor.

    Raises
    ------
    RecordingError
        If a deviation is negative or above 50 %.
    """

    effort_gain: float = 2.0
    effort_offset: float = 0.7
    power_gain: float = 1.0
    power_offset: float = 0.2
    speed_gain: float = 1.0

    def __post_init__(self) -> None:
        for name, percent in asdict(self).items():
            if not 0 <= percent <= MAX_PERCENT:
                raise RecordingError(f"--gauge {name} = {percent:g} %: must lie within 0 to {MAX_PERCENT:g} %.")

    @classmethod
    def from_percent(cls, percent: Mapping[str, float]) -> "GaugeErrors":
        """Return the defaults with other deviations by name [%].

        Raises
        ------
        RecordingError
            If a name is unknown or a deviation is negative or above 50 %.
        """
        for name in percent:
            if name not in GAUGE_ERRORS:
                raise RecordingError(f"--gauge {name}: must be among {', '.join(GAUGE_ERRORS)}.")
        return cls(**percent)


GAUGE_ERRORS = tuple(one.name for one in fields(GaugeErrors))
EFFORT_GAIN, EFFORT_OFFSET, POWER_GAIN, POWER_OFFSET, SPEED_GAIN = GAUGE_ERRORS


@dataclass(frozen=True)
class GaugeError:
    """A calibration error with its place in a fit.

    Parameters
    ----------
    name : str
        One of `GAUGE_ERRORS`.
    deviation : float
        The stated standard deviation [N or W of offsets].
    value : float
        The most likely error; of gains the logarithm of the factor, so that no trial of a fit makes that negative.
    """

    name: str
    deviation: float
    value: float = 0.0

    @property
    def error(self) -> float:
        """The most likely error: a share of gains, N or W of offsets."""
        return self.value if self.unit else math.expm1(self.value)

    @property
    def words(self) -> str:
        """The error in words: 'offset of the effort'."""
        gauge, _, kind = self.name.partition("_")
        return f"{kind} of the {gauge}"

    @property
    def unit(self) -> str:
        """Unit of the values: empty for a share."""
        return {EFFORT_OFFSET: "N", POWER_OFFSET: "W"}.get(self.name, "")

    def shown(self, error: float) -> str:
        """Return an error with its unit: % for gains, kN or kW for offsets."""
        return f"{error / 1e3:.3g} k{self.unit}" if self.unit else f"{100 * error:.3g} %"
