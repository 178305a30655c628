"""Induction machines, controlled along their rotor flux: steady state, least losses, limits."""
