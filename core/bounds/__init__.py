"""The least energy of a task and what is proven of it: what strategies, studies and checks share.

`minimum` finds the optimum: `minimise` that of a task, `minimise_decided` that with the drive on in given cells alone.
`certified` turns its multipliers into a bound for every driving of the train: any multipliers prove some lower bound,
those of the optimum the best one, so that a solver's fault makes a bound weak, never wrong. `certify` returns it,
`bound_of` optimum and bound at once, and `bounded` gives a run of any strategy a bound that covers its time.
`tightening` raises the bound of a drive that idles step by step, for runs over one mesh; `tightened` is its last step.
`strongest_bounds` lets bounds of several timetables strengthen one another, and `time_line` has one for every time.

Read `minimum.minimise` first, then `certified.certify`; the method itself is in `railjoule.core.interior_point`.
"""

from railjoule.core.bounds.certified import (
    bound_of,
    bounded,
    certify,
    chain_proof,
    chain_target_j,
    every_run_statement,
    with_chains,
    work_floor_j,
)
from railjoule.core.bounds.minimum import Solution, minimise, minimise_decided
from railjoule.core.bounds.over_time import TimeLine, time_line
from railjoule.core.bounds.proof_steps import (
    FIRST_STAGE_BOXES,
    LONGEST_PROOF_S,
    ProofStep,
    can_tighten,
    check_seconds,
    run_to_prove,
    tightened,
    tightening,
    with_tighter_bound,
)
from railjoule.core.bounds.timetables import strongest_bounds

__all__ = [
    "FIRST_STAGE_BOXES",
    "LONGEST_PROOF_S",
    "ProofStep",
    "Solution",
    "TimeLine",
    "bound_of",
    "bounded",
    "can_tighten",
    "certify",
    "chain_proof",
    "chain_target_j",
    "check_seconds",
    "every_run_statement",
    "minimise",
    "minimise_decided",
    "run_to_prove",
    "strongest_bounds",
    "tightened",
    "tightening",
    "time_line",
    "with_chains",
    "with_tighter_bound",
    "work_floor_j",
]
