"""Printed figures of the four papers, rebuilt from runs."""
