"""The toolbar of a figure: Bokeh's full screen, and saving the figure as a picture."""

from bokeh.models import FullscreenTool, SaveTool
from bokeh.plotting import figure

from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.look.tokens import FONT
from railjoule.dashboard.look.words import slug

FIGURE_CSS = ":host(:fullscreen) { background: var(--rj-surface); }"
TOOLBAR_CSS = """
:host { --icon-color: var(--rj-ink3); --highlight-color: var(--rj-accent); }
:host(.bk-hidden) { visibility: visible; opacity: 1; }
@media (hover: hover) { :host(.bk-hidden) > :not(:focus-visible) { opacity: 0; } }
:host > .bk-horizontal, :host > .bk-vertical { background: var(--rj-surface); border-color: var(--rj-line2); }
"""
"""The toolbar is invisible until the mouse or the keyboard focus is there; touch screens always show it."""


def add_tools(f: figure, caption: str, palette: Palette) -> None:
    """Add full screen and saving to the toolbar of a figure, and hide the buttons of all other tools.

    Parameters
    ----------
    f : figure
    caption : str
        The title of the figure on the full screen, and the name of the saved picture.
    palette : Palette
    """
    for tool in f.tools:
        tool.visible = False
    f.add_tools(FullscreenTool(), SaveTool(filename=slug(caption)))
    f.toolbar.update(logo=None, autohide=True, stylesheets=[TOOLBAR_CSS])
    f.update(toolbar_location="right", stylesheets=[*f.stylesheets, FIGURE_CSS])
    # assets/scripts/full_screen.js shows the title
    f.title.update(text=caption, visible=False, text_font=FONT, text_font_size="14px")
    palette.paint(f.title, text_color="ink2")
    # a saved picture needs the background of the page; fills leave pixels at the edges half painted, lines do not
    places = ("background_fill", "border_fill", "outline_line", "border_line")
    palette.paint(f, **{f"{place}_color": "surface" for place in places})


def name_picture(f: figure, scenario: str, caption: str) -> None:
    """Name the file of a saved picture after its scenario and its figure."""
    name = "-".join(filter(None, (slug(scenario), slug(caption))))
    for tool in f.tools:
        if isinstance(tool, SaveTool) and tool.filename != name:
            tool.filename = name
