"""The toolbar of a figure: Bokeh's full screen, and saving the figure as a picture."""

from bokeh.models import FullscreenTool, SaveTool
from bokeh.plotting import figure

from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.look.words import slug

FIGURE_CSS = """
:host(:fullscreen) { background: var(--rj-surface); }
:host(:fullscreen)::before { content: attr(aria-label); position: absolute; z-index: 1; top: 6px; right: 40px;
  max-width: calc(100% - 110px); padding: 2px 8px; border-radius: 6px; text-align: right; pointer-events: none;
  font: 600 14px/1.3 var(--rj-font); color: var(--rj-ink2);
  background: color-mix(in srgb, var(--rj-surface) 80%, transparent); }
"""
"""On the full screen, the name of the figure is its title."""
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
        The name of the saved picture.
    palette : Palette
    """
    for tool in f.tools:
        tool.visible = False
    f.add_tools(FullscreenTool(), SaveTool(filename=slug(caption)))
    f.toolbar.update(logo=None, autohide=True, stylesheets=[TOOLBAR_CSS])
    f.update(toolbar_location="right", stylesheets=[*f.stylesheets, FIGURE_CSS])
    # a saved picture needs the background of the page; fills leave pixels at the edges half painted, lines do not
    places = ("background_fill", "border_fill", "outline_line", "border_line")
    palette.paint(f, **{f"{place}_color": "surface" for place in places})


def name_picture(f: figure, scenario: str, caption: str) -> None:
    """Name the file of a saved picture after its scenario and its figure."""
    name = "-".join(filter(None, (slug(scenario), slug(caption))))
    for tool in f.tools:
        if isinstance(tool, SaveTool) and tool.filename != name:
            tool.filename = name
