"""The physics of a run, each rule once: what resists, what moves a cell, which effort there is, what the line gives.

Solvers, account, simulations and proofs call these; none of them writes a rule down again.
"""
