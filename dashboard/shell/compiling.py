"""The line above a page's results while the solver is being compiled, on the first start of a version."""

from railjoule.dashboard.look.markup import markup
from railjoule.dashboard.look.theme import parts_css
from railjoule.dashboard.parts.html import html_pane

COMPILING_CSS = """
.compiling { display: flex; flex-wrap: wrap; align-items: center; gap: 4px 12px; margin: 10px 20px 0 14px;
  padding: 6px 12px; font-size: 13px; color: var(--rj-ink2); background: var(--rj-surface);
  border: 1px solid var(--rj-line2); border-radius: 6px; }
.compiling progress { appearance: none; flex: 0 1 160px; height: 4px; border: 0; border-radius: 2px; overflow: hidden;
  background: var(--rj-line2); }
.compiling progress::-webkit-progress-bar { background: var(--rj-line2); }
.compiling progress::-webkit-progress-value { background: var(--rj-accent); }
.compiling progress::-moz-progress-bar { background: var(--rj-accent); }
"""


class CompilingNote:
    """Shows how far the compilation is, and that results which need it appear by themselves."""

    def __init__(self) -> None:
        self.view = html_pane(stylesheets=[parts_css(), COMPILING_CSS], visible=False)

    def show(self, share: float) -> None:
        """Show the share that is done, from 0 to 1."""
        words = markup(
            '<div class="compiling" role="status">The solver is being compiled, once on this machine: {percent} %'
            '<progress aria-label="Compiled" value="{percent}" max="100"></progress>'
            "Simple runs are shown already. All other results appear here by themselves, within about a minute.</div>",
            percent=round(100 * share),
        )
        self.view.param.update(object=words, visible=True)

    def hide(self) -> None:
        """Remove the line."""
        self.view.param.update(object="", visible=False)
