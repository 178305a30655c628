"""What stands in the place of a page while the kernels compile, on the very first start."""

import panel_material_ui as pmui

from railjoule.dashboard.look.markup import Markup, markup
from railjoule.dashboard.look.theme import parts_css
from railjoule.dashboard.parts.html import html_pane, stack

SKETCH = (
    '<svg viewBox="0 0 600 120" width="100%" height="220" preserveAspectRatio="none" aria-hidden="true" '
    'style="display:block;margin:16px 0">'
    '<path d="M2 116 C 20 30 40 20 90 20 L 470 20 C 540 20 580 60 598 116" fill="none" stroke="var(--rj-line2)" '
    'stroke-width="2" vector-effect="non-scaling-stroke"/>'
    '<path d="M0 118 H600" stroke="var(--rj-line)" stroke-width="1" vector-effect="non-scaling-stroke"/></svg>'
)
BEHIND_CSS = """
:host { position: fixed !important; right: 16px; bottom: 12px; z-index: 900; width: auto !important; }
.behind { padding: 6px 12px; font-size: 12px; color: var(--rj-ink2); background: var(--rj-surface);
  border: 1px solid var(--rj-line2); border-radius: 6px; }
"""
BEHIND = Markup('<div class="behind" role="status">Compiling the solver for the other pages, once</div>')


class StartingView:
    """Progress over a grey sketch of a run; then, beside an open page, that the other pages' kernels are to come."""

    def __init__(self) -> None:
        self.words = html_pane()
        self.bar = pmui.LinearProgress(value=0, width=320, height=4, margin=(8, 0))
        self.view = stack(
            self.words, self.bar, html_pane(SKETCH), styles={"padding": "28px 20px", "max-width": "900px"}
        )
        self.behind = html_pane(stylesheets=[parts_css(), BEHIND_CSS], visible=False)
        self.tell(0, 0)

    def tell(self, done: int, total: int) -> None:
        """Say how many kernels are ready."""
        self.words.object = markup(
            '<h1>Starting</h1><p role="status" style="margin-top:6px">Compiling the solver, once{}. '
            '<span class="muted">The next start takes a second.</span></p>',
            f": {done} of about {total}" if total else "",
        )
        self.bar.value = int(100 * done / total) if total else 0

    def tell_behind(self, compiling: bool) -> None:
        """Say that a page that is turned to now may have to wait, or no longer say so."""
        self.behind.param.update(object=BEHIND if compiling else "", visible=compiling)
