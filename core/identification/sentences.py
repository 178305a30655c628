"""The findings of a fit in sentences: how the runs contradict the model, and which parameters they leave open."""

from collections.abc import Sequence

import numpy as np
import scipy

from railjoule.core.identification.gauges import GaugeError
from railjoule.core.identification.parameters import (
    AUXILIARY,
    EFFICIENCY,
    MASS,
    MASS_FACTOR,
    MOTION,
    RESISTANCE,
    UNITS,
    Range,
)

SIGNIFICANT = 0.99
"""Probability with which runs of a train that the model describes stay below the limits of a contradiction."""
LARGEST_RATIO = 3.0
"""By which the residual of the speed may exceed that of usual errors: a recorder may well be twice as noisy."""


def contradiction(
    names: Sequence[str],
    estimate: Range,
    gauge_errors: Sequence[GaugeError],
    residual_ms: float,
    expected_residual_ms: float,
) -> str:
    """Return how runs contradict the model, in a sentence; empty where they do not.

    Parameters
    ----------
    names : sequence of str
        The parameters of `estimate`.
    estimate, gauge_errors, residual_ms, expected_residual_ms
        As `railjoule.core.identification.Fit`.
    """
    reasons, limit = _outside(names, estimate), float(scipy.stats.norm.ppf(0.5 + 0.5 * SIGNIFICANT))
    reasons += [
        f"the {gauge.words} would have to be {gauge.shown(gauge.error)}, {abs(gauge.value) / gauge.deviation:.1f} "
        "times the assumed standard deviation"
        for gauge in gauge_errors
        if abs(gauge.value) > limit * gauge.deviation
    ]
    if residual_ms > LARGEST_RATIO * expected_residual_ms:
        reasons.append(
            f"the simulated speed misses the measured one by {residual_ms:.2g} m/s, "
            f"{residual_ms / expected_residual_ms:.1f} times the noise of usual gauges"
        )
    if not reasons:
        return ""
    return (
        f"These runs contradict the model, so the intervals are not valid: {'; '.join(reasons)}; check the gauges, the "
        "mass, the gradients and the place of the runs on the line."
    )


def _outside(names: Sequence[str], estimate: Range) -> list[str]:
    """Return the parameters that leave the range of trains by more than chance, each in a clause."""
    _, distance = estimate.nearest()
    found = estimate.estimate
    leaves = (found < estimate.low) | (found > estimate.high)
    if distance <= scipy.stats.chi2.ppf(SIGNIFICANT, max(int(leaves.sum()), 1)):
        return []
    farthest = int(np.argmax(np.maximum(estimate.low - found, found - estimate.high) / estimate.deviation))
    name = names[farthest]
    return [
        f"without bounds {name} would be {found[farthest]:.4g} {UNITS[name]}".rstrip()
        + f", and all parameters within the range of trains are {np.sqrt(distance):.1f} standard deviations away"
    ]


def assumed_errors(gauge_errors: Sequence[GaugeError]) -> str:
    """Return the assumed standard deviations of calibration errors, in a sentence."""
    if not gauge_errors:
        return "The gauges are taken as exact."
    errors = [f"{gauge.words} {gauge.shown(gauge.deviation)}" for gauge in gauge_errors]
    return f"Assumed standard deviations of the gauges' errors: {_listed(errors)}."


def open_parameters(
    undetermined: Sequence[str], undetermined_by_gauges: Sequence[str], confounded: Sequence[Sequence[str]]
) -> tuple[str, ...]:
    """List parameters that are not identifiable, and the runs that would determine them.

    Parameters
    ----------
    undetermined, undetermined_by_gauges, confounded
        As `railjoule.core.identification.Fit`.
    """
    sentences = [f"{_listed(group)} cannot be separated by these runs{_remedy(group)}." for group in confounded]
    known = {*undetermined_by_gauges, *(name for group in confounded for name in group)}
    sentences += [
        f"These runs do not determine {name}{_remedy((name,))}." for name in undetermined if name not in known
    ]
    if undetermined_by_gauges:
        names = _listed(undetermined_by_gauges)
        sentences.append(f"The assumed errors of the gauges leave {names} open: gauges with smaller errors would not.")
    return tuple(sentences)


def _listed(names: Sequence[str]) -> str:
    return " and ".join([", ".join(names[:-1])] * (len(names) > 1) + [names[-1]])


def _remedy(names: Sequence[str]) -> str:
    """Return which other runs would determine parameters."""
    if set(names) <= set(RESISTANCE):
        return ": coasting from high to low speed would"
    if {MASS, MASS_FACTOR} & set(names) and set(names) <= set(MOTION):
        return ": measured efforts or coasting over known gradients would"
    if EFFICIENCY in names or AUXILIARY in names:
        return ": efforts measured beside the power would"
    return ""
