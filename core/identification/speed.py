"""The speed that a train with given parameters would have under the measured effort, sample after sample.

Between two samples force and mass give dv = (F - R(v) - line) dt / m, with the running resistance at the means that a
cell of the mesh takes. A section of samples begins at its first measured speed; later ones are never looked at again.
"""

import numpy as np

from railjoule.core.arrays import BoolArray, FloatArray
from railjoule.core.compiled import njit
from railjoule.core.physics.cell import mean_speed
from railjoule.core.physics.resistance import running_resistance

# a step changes the resistance by less than a thousandth of itself: three or four rounds leave rounding
MAX_ROUNDS = 30
EXACT_MS = 1e-12
"""Between two rounds the speed may still change by this."""
FASTEST_MS = 1e3
"""Parameters on trial may push a train; its speed ends here."""


@njit(cache=True, error_model="numpy", nogil=True)
def simulated_speed(
    step_s: FloatArray,
    start_speed_ms: FloatArray,
    begins: BoolArray,
    force_n: FloatArray,
    tunnel_factor: FloatArray,
    constant_n: float,
    linear: float,
    quadratic: float,
    inertia_kg: float,
) -> FloatArray:
    """Return the speed at the end of each step [m/s]; shape (n,).

    Parameters
    ----------
    step_s : array of shape (n,)
        Time between two samples [s].
    start_speed_ms : array of shape (n,)
        Measured speed at the start of each step, of which only those count where a section begins [m/s].
    begins : array of bool of shape (n,)
        Where a section begins.
    force_n : array of shape (n,)
        Effort less the forces of gradients and curves [N].
    tunnel_factor : array of shape (n,)
        Factor on the quadratic resistance.
    constant_n, linear, quadratic : float
        A [N], B [N s/m] and C [N s2/m2].
    inertia_kg : float
        Mass that resists acceleration [kg].
    """
    speed = np.empty(step_s.shape[0])
    before = 0.0
    for i in range(step_s.shape[0]):
        if begins[i]:
            before = start_speed_ms[i]
        after = before
        for _ in range(MAX_ROUNDS):
            v = mean_speed(before, after)
            speed2 = 0.5 * (before * before + after * after)
            resistance = running_resistance(constant_n, linear, quadratic * tunnel_factor[i], v, speed2)
            # a resistance never pushes back: parameters on trial may be wild, and speeds stay squares' roots
            reached = min(max(before + (force_n[i] - resistance) * step_s[i] / inertia_kg, 0.0), FASTEST_MS)
            change = reached - after
            after = reached
            if abs(change) <= EXACT_MS:
                break
        speed[i] = after
        before = after
    return speed
