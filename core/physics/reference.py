"""What energies are compared with: a gap relative to nothing would say nothing."""

from railjoule.core.compiled import njit
from railjoule.core.physics.course_data import CourseData

# downhill a run may need nothing at all, and what differs is then small beside what the train has in motion, not beside
# zero
SMALL_ENERGY_SHARE = 0.1
"""Energies near zero are compared with this share of the kinetic energy at the mean speed."""


@njit(cache=True)
def reference_energy(course: CourseData, energy: float, running_time: float) -> float:
    """Return the size of an energy [J], but no less than a share of the kinetic energy at a run's mean speed.

    Parameters
    ----------
    course : CourseData
    energy : float
        What is to be compared [J].
    running_time : float
        Time of the run, dwells not included [s].
    """
    mean = course.cell_length_m.sum() / running_time
    smallest: float = SMALL_ENERGY_SHARE * course.half_inertia_kg * mean * mean
    return max(abs(energy), smallest)
