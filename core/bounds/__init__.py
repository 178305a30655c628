"""The least energy of a task and what is proven of it: what strategies, studies and checks share.

`minimise` finds the optimum, `certify` the energy that no run on the same mesh undercuts, `bound_of` both at once;
`bounded` gives a run a bound that covers it.
"""

from railjoule.core.bounds.certified import PROOF_BUDGET, bound_of, bounded, certify, work_floor_j
from railjoule.core.bounds.minimum import Solution, minimise, minimise_decided

__all__ = [
    "PROOF_BUDGET",
    "Solution",
    "bound_of",
    "bounded",
    "certify",
    "minimise",
    "minimise_decided",
    "work_floor_j",
]
