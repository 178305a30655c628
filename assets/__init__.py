"""Vehicles, lines, scenarios, the papers' printed numbers, and what the page is drawn with."""
