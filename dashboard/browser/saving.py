"""Saving what is shown, in the browser alone: figures as PNG, SVG and CSV, tables as CSV, the advice as text."""

from panel.custom import JSComponent

from railjoule.dashboard.look.scripts import module


class Saving(JSComponent):
    """Gives each figure its menu, and the buttons of tables and of the advice their work."""

    _esm = module("saving")
