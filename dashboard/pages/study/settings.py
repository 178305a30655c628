"""The sidebar's part of Study: what varies, how the runs are drawn, the estimate, and the file of a former study."""

from typing import Any

import panel as pn
import panel_material_ui as pmui
import param

from railjoule.core.strategies import STRATEGIES
from railjoule.dashboard.editor.forms import Form
from railjoule.dashboard.keep.keeping import shown_name
from railjoule.dashboard.library_workarounds import SmallFile
from railjoule.dashboard.limits import LARGEST_STUDY_BYTES
from railjoule.dashboard.look import words
from railjoule.dashboard.look.markup import markup
from railjoule.dashboard.look.scripts import module
from railjoule.dashboard.look.theme import editor_css, study_css
from railjoule.dashboard.pages.study.fields import MOST_VARIED, fields_that_vary
from railjoule.dashboard.pages.study.model import Brought
from railjoule.dashboard.parts.html import html_pane, stack
from railjoule.dashboard.parts.number_field import number_fields, tie
from railjoule.dashboard.state.workbench import Workbench

METHOD_WORDS = {
    "evenly, Sobol\u2019 sequence": "sobol",
    "evenly, Halton sequence": "halton",
    "at random": "random",
    "grid": "grid",
}
START, AGAIN = "Run", "Change and start again"
END = "A study ends with its page: a stopped one can go on, and a saved one can be opened again."
TOO_LARGE = (
    f"The file is larger than the {LARGEST_STUDY_BYTES / 1e6:g} MB that this page opens; Python's xarray reads it."
)
STUDY_SUFFIX = ".nc"
SELECT: dict[str, Any] = {"size": "small", "margin": (8, 16, 4, 16), "sizing_mode": "stretch_width"}


class FieldRanges(Form):
    """The fields with their ranges, drawn and dragged in the browser."""

    fields = param.List(default=[], doc="What each row shows.")
    groups = param.List(default=[], doc="Fields that can be added, by their tables.")
    note = param.String(default="", doc="How many fields vary, of how many.")
    version = param.Integer(default=0, doc="Counts what was sent: the browser shows the model's numbers at each.")

    _esm = module("study_fields")

    def __init__(self, state: Workbench) -> None:
        super().__init__(self._take, stylesheets=[editor_css(), study_css()])
        self.state, self.model = state, state.study
        self.model.param.watch(self.show, ["over", "refused"])
        self.show()

    def show(self, *_: Any) -> None:
        """Show the ranges as they are."""
        known, model = fields_that_vary(self.state.scenario.edited), self.model
        rows = []
        for path, (low, high) in model.over.items():
            field = known.get(path)
            least, most = (low, high) if field is None else field.ends
            rows.append(
                {
                    "path": path,
                    "label": path if field is None else field.label.removesuffix(f", {words.UNKNOWN}"),
                    "low": low,
                    "high": high,
                    "least": min(least, low, high),
                    "most": max(most, low, high),
                    "step": "any" if field is None else field.step,
                    "refusal": model.refused.get(path, ""),
                }
            )
        groups: dict[str, list[list[str]]] = {}
        if len(rows) < MOST_VARIED:
            for path, field in known.items():
                if path not in model.over:
                    name = field.label.removesuffix(f", {words.UNKNOWN}")
                    groups.setdefault(field.group, []).append([path, name])
        self.param.update(
            fields=rows,
            groups=[[group, fields] for group, fields in groups.items()],
            note=f"\u00b7 {len(rows)} of {len(known)}",
            version=self.version + 1,
        )

    def _take(self, message: dict[str, Any]) -> None:
        what, path = message.get("what"), str(message.get("path"))
        scenario = self.state.scenario.edited
        with pn.io.hold():
            if what == "range":
                self.model.set_range(scenario, path, str(message.get("low")), str(message.get("high")))
            elif what == "add":
                self.model.add(scenario, path)
            elif what == "remove":
                self.model.remove(path)
            # a number that was typed otherwise than it reads is written anew, even where it has not changed
            self.version += 1


class StudyFields:
    """Fields, method, estimate and the button that opens a file; in sight only on Study."""

    def __init__(self, state: Workbench) -> None:
        self.state, self.model = state, state.study
        model = self.model
        self.method = pmui.Select(label="Spread", options=METHOD_WORDS, value=model.method, **SELECT)
        options = {words.strategy(name): name for name in STRATEGIES}
        self.strategy = pmui.Select(label="Strategy", options=options, value=model.strategy, **SELECT)
        self.told = html_pane()
        self.begin = pmui.Button(
            label=START,
            variant="outlined",
            size="small",
            margin=(8, 8, 8, 16),
            on_click=lambda _: model.param.trigger("start"),
        )
        self.file = SmallFile(
            refuse=lambda: setattr(model, "refusal", TOO_LARGE),
            label="Open a study",
            uploaded_label="Open a study",
            accept=STUDY_SUFFIX,
            max_file_size=LARGEST_STUDY_BYTES,
            icon="folder_open",
            variant="text",
            size="small",
            margin=(0, 8, 8, 8),
        )
        self.file.param.watch(self._open, "value")
        self.view = stack(
            FieldRanges(state),
            html_pane('<div class="section">Method</div>'),
            self.method,
            self.strategy,
            *number_fields(model, "runs", "seed"),
            self.told,
            self.begin,
            self.file,
        )
        tie(self.method, model, "method")
        tie(self.strategy, model, "strategy")
        model.param.watch(self._show, ["estimate", "current", "asked", "study", "progress", "refusal"])
        self._show()

    def _open(self, event: Any) -> None:
        if event.new:
            self.model.brought = Brought(shown_name(str(self.file.filename)), event.new)
            # so that the page does not keep the bytes
            self.file.clear()

    def _show(self, *_: Any) -> None:
        model = self.model
        same = model.study is not None and model.asked is not None and model.asked == model.current
        self.begin.label = START if model.study is None else AGAIN
        estimate = model.estimate
        known = estimate is not None and estimate.request == model.current
        refusal = model.refusal or (estimate.refusal if known and estimate is not None else "")
        self.begin.disabled = model.progress.is_under_way or same or (known and bool(refusal) and not model.refusal)
        if refusal:
            told = markup('<p class="error" role="alert" style="color:var(--rj-bad)">{}</p>', refusal)
        elif same and not model.progress.is_under_way:
            told = markup('<p class="muted">Change a field, the runs or the seed to start again.</p>')
        elif known and estimate is not None and estimate.seconds is not None:
            told = markup('<p class="muted">{} {}</p>', estimate_words(estimate.seconds), END)
        else:
            told = markup('<p class="muted">{}</p>', END)
        self.told.object = markup('<div style="padding:6px 16px 0;font-size:12px">{}</div>', told)


def estimate_words(seconds: float) -> str:
    """Return how long a study takes, in a sentence."""
    return f"About {duration_words(seconds)} on this computer."


def duration_words(seconds: float) -> str:
    """Return a time that is known roughly."""
    if seconds < 90:
        return f"{words.number(max(seconds, 1), 0)} s"
    return f"{words.number(seconds / 60, 0)} min" if seconds < 5400 else f"{words.number(seconds / 3600, 1)} h"
