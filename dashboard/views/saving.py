"""Saving what is shown, in the browser alone: figures as PNG, SVG and CSV, tables as CSV, the advice as text."""

from importlib.resources import files

from panel.custom import JSComponent


class Saving(JSComponent):
    """Gives each figure its menu, and the buttons of tables and of the advice their work."""

    _esm = (files("railjoule.assets") / "scripts" / "saving.js").read_text(encoding="utf-8")
