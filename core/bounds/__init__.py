"""The least energy of a task and what is proven of it: what strategies, studies and checks share.

- `minimum` finds the optimum: `minimise` that of a task, `minimise_decided` that with a decision for each cell.
- `certified` turns its multipliers into a bound for every driving of the train: any multipliers prove some lower bound,
  those of the optimum the best one, so that a solver's fault makes a bound weak, never wrong.
- `chain_bound` raises the bound of a drive with idle losses step by step, for runs over one mesh.

Read `minimum.minimise` first, then `certified.certify`; the method itself is in `railjoule.core.interior_point`.
"""

from railjoule.core.bounds.certified import (
    bounded,
    certify,
    every_run_statement,
    find_bound,
    strongest_bounds,
    time_line,
    work_floor_j,
)
from railjoule.core.bounds.chain_bound import (
    FIRST_STAGE_BOXES,
    LONGEST_PROOF_S,
    OPTIMUM,
    ProofStep,
    can_tighten,
    check_seconds,
    run_to_prove,
    tightened,
    tightening,
    with_tighter_bound,
)
from railjoule.core.bounds.minimum import Solution, minimise, minimise_decided

__all__ = [
    "FIRST_STAGE_BOXES",
    "LONGEST_PROOF_S",
    "OPTIMUM",
    "ProofStep",
    "Solution",
    "bounded",
    "can_tighten",
    "certify",
    "check_seconds",
    "every_run_statement",
    "find_bound",
    "minimise",
    "minimise_decided",
    "run_to_prove",
    "strongest_bounds",
    "tightened",
    "tightening",
    "time_line",
    "with_tighter_bound",
    "work_floor_j",
]
