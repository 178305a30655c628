"""Bellman's dynamic programming over the speeds of a mesh."""
