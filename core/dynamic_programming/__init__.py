"""Bellman's dynamic programming over the speeds of a mesh; behind the strategy `bellman`, and a last resort of others.

At a price of time the cheapest run is found backwards: `backward` lays a grid of speeds over each node, tabulates all
steps between neighbouring nodes once, and sweeps from the end to the start for the least cost to go from each point.
`rollout` then drives forward, in each cell to the speed that is cheapest with the cost to go from there. `search` finds
the price at which that run takes the running time, and repeats it on finer and finer grids around the run found.
`on_off` searches a band of speeds for decisions that keep a drive on or off for a minimum time: `memory` holds what its
states remember beside the speed, and `power_table` prices its steps.

Read `search.search` first, the whole in forty lines, then `backward.sweep_back`, the recursion itself, and
`rollout.best_exit`. How far a control leads and what a step costs is physics: `railjoule.core.motion.cell_step`.
"""
