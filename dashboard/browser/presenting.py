"""The button that shows the page's figures on the wall, one by one.

All of it happens in the browser; the server is told how wide figures are laid out meanwhile, and places the names of
lines accordingly.
"""

from importlib.resources import files

import param
from panel.custom import JSComponent

from railjoule.dashboard.look.scripts import module

ASSETS = files("railjoule.assets")


class Presenting(JSComponent):
    """Shows one figure of the page in sight on the whole screen, with keys to go on; the figures stay live.

    The button is there on every page with figures.
    """

    page = param.String(default="", doc="The page in sight: a presentation ends with it.")
    slider = param.String(default="", doc="Label of the sidebar's slider that the presentation has, too.")
    figure_px = param.Integer(
        default=0, doc="How wide figures are laid out while one is presented [px]; 0 while none is."
    )

    _esm = module("present")
    _stylesheets = [(ASSETS / "css" / "present.css").read_text(encoding="utf-8")]  # noqa: RUF012
