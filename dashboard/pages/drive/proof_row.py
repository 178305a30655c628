"""The bound of the run on Drive in a sentence below its numbers, with buttons to prove further and to show prices."""

from collections.abc import Callable

import panel_material_ui as pmui

from railjoule.core import Trajectory
from railjoule.core.bounds import ProofStep
from railjoule.core.lower_bound import Bound
from railjoule.dashboard.look import words
from railjoule.dashboard.look.glossary import info
from railjoule.dashboard.look.markup import Markup, markup
from railjoule.dashboard.parts.html import html_pane, stack
from railjoule.dashboard.state.workbench import Workbench

ROW_CSS = """
:host { display: grid; grid-template-columns: minmax(0, 1fr); grid-auto-flow: column; column-gap: 16px;
  align-items: start; padding: 6px 20px 0; box-sizing: border-box; }
@media (max-width: 899px) { :host { grid-auto-flow: row; padding: 6px 14px 0; } }
"""
FURTHER, STOP = "Prove further", "Stop"
SHOW_PRICES, HIDE_PRICES = "Show price of force", "Hide price of force"
BOXES = 1e6
EXHAUSTED = "The page proves no more; the command line does, with --prove-seconds."


class ProofRow:
    """The sentence and its buttons; none of them proves further where the run is proven."""

    def __init__(self, state: Workbench) -> None:
        self.state, self.model = state, state.proof
        self.text = html_pane()
        # one button, so that the keyboard's focus stays where it is
        self.button = _text_button(FURTHER, self._press)
        self.prices = _text_button(SHOW_PRICES, self._turn_prices)
        row = stack(self.text, self.button, self.prices, css=ROW_CSS)
        # around it, as the row's own display would show what is hidden
        self.view = stack(row, visible=False)

    def _press(self, _: object) -> None:
        self.model.param.trigger("stop" if self.model.stage == "further" else "go_on")

    def _turn_prices(self, _: object) -> None:
        self.model.has_prices_open = not self.model.has_prices_open

    def show(self, run: Trajectory | None, hidden: bool) -> None:
        """Show what is proven of a run."""
        bound, stage, runs = None if run is None else run.bound, self.model.stage, self.state.runs
        # what is proven of a run over other nodes or with a time of its own is another proof
        own = bound is not None and runs is not None and runs.to_prove is not None and runs.to_prove.bound is bound
        self.view.visible = not hidden and bound is not None
        if hidden or run is None or bound is None:
            return
        self.prices.visible = bound.costate is not None
        self.prices.label = HIDE_PRICES if self.model.has_prices_open else SHOW_PRICES
        known = self.model.of(run.scenario)
        end: str
        if own and stage:
            end = progress(self.model.step)
        elif own and known is not None and known.is_complete:
            # a smooth drive has no further proof
            end = EXHAUSTED if known.step.boxes else ""
        else:
            end = self._failure if own else ""
        self.text.object = proof_text(bound, end)
        self.button.visible = own and (known is None or not known.is_complete or bool(stage))
        self.button.label = STOP if stage == "further" else FURTHER
        # that stage ends by itself after about half a second
        self.button.disabled = stage == "first"

    @property
    def _failure(self) -> str:
        failure = self.model.failure
        return "" if failure is None else f"The proof has ended: {failure}"


def _text_button(label: str, press: Callable[[object], None]) -> pmui.Button:
    """Return a button at the right of the sentence, or below it on a narrow screen."""
    return pmui.Button(
        label=label,
        variant="text",
        size="small",
        margin=0,
        height=28,
        sx={"px": 0},
        on_click=press,
    )


def proof_text(bound: Bound, end: str) -> Markup:
    """Return what a bound proves, as HTML, and at its end how far the proof is."""
    # how many boxes are used is not read aloud at every step, what is proven is
    return markup(
        '<div class="proof-row"><span role="status" aria-live="polite">{}</span>{} <span class="muted">{}</span></div>',
        bound.statement,
        info("Proof"),
        end,
    )


def progress(step: ProofStep | None) -> Markup:
    """Return how many boxes of its budget a proof has used, as HTML; None where it waits for others."""
    share, told = 0.0, "begins"
    if step is not None:
        share = step.share
        told = f"{words.number(step.boxes / BOXES)} of {words.number(step.budget / BOXES)} million boxes"
    bar = '<progress max="1" value="{}" aria-label="Share of the boxes looked at"></progress>{}'
    return markup(bar, f"{share:.3f}", told)
