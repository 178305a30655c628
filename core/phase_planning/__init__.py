"""Start / cruise / coast / brake runs: planned by searches over tables against speed; behind the strategy `phases`.

On a line without changes each phase depends only on speed, so that `tables` integrates time, distance and energy of
starting, coasting and braking once over speed. With them a run of given time and distance has one free number, the
speed of its cruise: `search` finds the best one in compiled code. `planner` adds what is chosen around it: the current
and the cycles of starts, and the times of parts between stops. A `plan` is the result; it is laid out
as the nodes of a trajectory, whose cells have constant effort and so differ from the tables by some millionths.

On a line with several limits or gradients, `stretches` drives one cycle per stretch cell by cell and searches the
speeds of all stretches for one price of time; `line_planner` finds the price whose run takes the given time.

Read the docstring of `search` first, then `planner.PhasePlanner.plan`.
"""
