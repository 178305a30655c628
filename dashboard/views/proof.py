"""What is proven of the run on Drive, in a sentence beneath its numbers, and the button that proves further."""

import panel as pn
import panel_material_ui as pmui

from railjoule.core import Trajectory
from railjoule.dashboard.look import comparisons, words
from railjoule.dashboard.look.glossary import info
from railjoule.dashboard.models.proof import Proven
from railjoule.dashboard.models.workbench import Workbench
from railjoule.dashboard.views.parts import escaped, html_pane

ROW_CSS = """
:host { display: grid; grid-template-columns: minmax(0, 1fr) auto; column-gap: 12px; align-items: start;
  padding: 6px 20px 0; box-sizing: border-box; }
@media (max-width: 899px) { :host { grid-template-columns: minmax(0, 1fr); padding: 6px 14px 0; } }
"""
FURTHER, STOP = "Prove further", "Stop"
BOXES = 1e6
COMPLETE = "As close as the proof aims."
EXHAUSTED = "The page proves no more; the command line does, with --prove-seconds."


class ProofRow:
    """The sentence and its button; a drive that takes no power without effort has neither, as its proof is complete."""

    def __init__(self, state: Workbench) -> None:
        self.state, self.model = state, state.proof
        self.text = html_pane()
        # one button, so that the keyboard's focus stays where it is
        self.button = pmui.Button(
            label=FURTHER,
            variant="text",
            size="small",
            margin=0,
            height=28,
            width=110,
            sx={"justifyContent": "flex-end", "@media (max-width: 899px)": {"justifyContent": "flex-start", "pl": 0}},
            on_click=self._press,
        )
        self.view = pn.Column(
            self.text, self.button, margin=0, sizing_mode="stretch_width", stylesheets=[ROW_CSS], visible=False
        )

    def _press(self, _: object) -> None:
        self.model.param.trigger("stop" if self.model.stage == "further" else "go_on")

    def show(self, run: Trajectory | None, hidden: bool) -> None:
        """Show what is proven of a run."""
        bound = None if run is None else run.bound
        self.view.visible = shown = not hidden and bound is not None and bound.switched_j is not None
        if not shown or run is None:
            return
        known, stage = self.model.of(run.scenario), self.model.stage
        # what is proven of a run over other nodes or with a time of its own is another proof
        own = self.state.runs is not None and self.state.runs.to_prove is not None
        own = own and self.state.runs.to_prove.bound is bound
        self.text.object = proof_text(run, known if own else None, stage if own else "", self._failure)
        self.button.visible = own and (known is None or not known.is_complete or bool(stage))
        self.button.label = STOP if stage == "further" else FURTHER
        self.button.disabled = stage == "first"

    @property
    def _failure(self) -> str:
        failure = self.model.failure
        return "" if failure is None else f"The proof has ended: {failure}"


def proof_text(run: Trajectory, known: Proven | None, stage: str, failure: str) -> str:
    """Return what is proven of a run, as HTML: the sentence, and how far the proof is."""
    assert run.bound is not None
    sentence = escaped(comparisons.proof_sentence(run.bound))
    end = escaped(failure)
    if stage:
        end = _progress(known)
    elif known is not None and known.is_complete:
        end = COMPLETE if known.step.reached else EXHAUSTED
    # how many boxes are used is not read aloud at every step, what is proven is
    told = f'<span role="status" aria-live="polite">{sentence}</span>{info("Proof")}'
    return f'<div class="proof-row">{told} <span class="muted">{end}</span></div>'


def _progress(known: Proven | None) -> str:
    """Return how many boxes of the budget are used, as HTML; the steps before this proof's first are another's."""
    step = None if known is None else known.step
    share, told = 0.0, "begins"
    if step is not None:
        share = step.share
        told = f"{words.number(step.boxes / BOXES)} of {words.number(step.budget / BOXES)} million boxes"
    bar = f'<progress max="1" value="{share:.3f}" aria-label="Share of the boxes looked at"></progress>'
    return f"{bar}{told}"
