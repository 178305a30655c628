"""Bellman's dynamic programming over the speeds of a mesh; behind the strategy `bellman`, and a last resort of others.

A state is a square of speed at a node and a label, which holds what it remembers: nothing, how long a drive must stay
on or off, or how often a driver may still change the regime (`labels`). `grid` makes the speeds of each node, `steps`
tabulates all steps between neighbouring nodes once, and `recursion` sweeps from the end to the start for the least cost
to go, then drives forward to the speeds that are cheapest with it. `search` finds the price of time at which that run
takes the running time, and repeats it on finer and finer grids around the run found. `on_off` searches a band of speeds
for decisions that keep a drive on or off for a minimum time, with steps that `power_table` prices. `regimes` drives
given regimes.

Read `search.search` first, the whole in forty lines, then `recursion`. The speed to which a control leads and the cost
of a step are physics: `railjoule.core.motion.cell_step`.
"""
