"""What a page says in its corner while the kernels compile, on the very first start."""

from railjoule.dashboard.look.markup import markup
from railjoule.dashboard.look.theme import parts_css
from railjoule.dashboard.parts.html import html_pane

CORNER_CSS = """
:host { position: fixed !important; right: 16px; bottom: 12px; z-index: 900; width: auto !important; }
.corner { padding: 6px 12px; font-size: 12px; color: var(--rj-ink2); background: var(--rj-surface);
  border: 1px solid var(--rj-line2); border-radius: 6px; }
.corner progress { appearance: none; display: block; width: 100%; height: 4px; margin: 5px 0 3px; border: 0;
  border-radius: 2px; overflow: hidden; background: var(--rj-line2); }
.corner progress::-webkit-progress-bar { background: var(--rj-line2); }
.corner progress::-webkit-progress-value { background: var(--rj-accent); }
.corner progress::-moz-progress-bar { background: var(--rj-accent); }
@media (max-width: 899px) { :host { left: 16px; } }
"""


class CompilingNote:
    """How many kernels are there, over what the page shows already."""

    def __init__(self) -> None:
        self.view = html_pane(stylesheets=[parts_css(), CORNER_CSS], visible=False)

    def tell(self, done: int, total: int) -> None:
        """Say how many kernels are ready, of about how many."""
        words = markup(
            '<div class="corner" role="status">Compiling the solver, once: {done} of about {total}'
            '<progress aria-label="Compiled" value="{done}" max="{total}"></progress>'
            "Figures come as their part is ready; the next start takes a second.</div>",
            done=done,
            total=total,
        )
        self.view.param.update(object=words, visible=True)

    def done(self) -> None:
        """Say no more of it."""
        self.view.param.update(object="", visible=False)
