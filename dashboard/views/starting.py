"""What stands in the place of a page while the kernels compile, on the very first start."""

import panel_material_ui as pmui

from railjoule.dashboard.look.markup import markup
from railjoule.dashboard.views.parts import html_pane, stack

SKETCH = (
    '<svg viewBox="0 0 600 120" width="100%" height="220" preserveAspectRatio="none" aria-hidden="true" '
    'style="display:block;margin:16px 0">'
    '<path d="M2 116 C 20 30 40 20 90 20 L 470 20 C 540 20 580 60 598 116" fill="none" stroke="var(--rj-line2)" '
    'stroke-width="2" vector-effect="non-scaling-stroke"/>'
    '<path d="M0 118 H600" stroke="var(--rj-line)" stroke-width="1" vector-effect="non-scaling-stroke"/></svg>'
)


class StartingView:
    """Progress over a grey sketch of a run."""

    def __init__(self) -> None:
        self.words = html_pane()
        self.bar = pmui.LinearProgress(value=0, width=320, height=4, margin=(8, 0))
        self.view = stack(
            self.words, self.bar, html_pane(SKETCH), styles={"padding": "28px 20px", "max-width": "900px"}
        )
        self.tell(0, 0)

    def tell(self, done: int, total: int) -> None:
        """Say how many kernels are ready."""
        self.words.object = markup(
            '<h1>Starting</h1><p role="status" style="margin-top:6px">Compiling the solver, once{}. '
            '<span class="muted">The next start takes a second.</span></p>',
            f": {done} of {total}" if total else "",
        )
        self.bar.value = int(100 * done / total) if total else 0
