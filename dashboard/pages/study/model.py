"""What the page Study asks for: fields with their ranges, how the runs are drawn, and what is looked at of them."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

import param

from railjoule.core import Scenario
from railjoule.core.strategy import STRATEGIES
from railjoule.core.studies.sweep import DEFAULT_COLUMNS, METHODS, Study
from railjoule.dashboard.editor.fields_of import Field
from railjoule.dashboard.pages.study.compute import ENERGY, RESULTS, Estimate, EstimateRequest, Look
from railjoule.dashboard.pages.study.fields import MOST_VARIED, fields_that_vary, first_ranges
from railjoule.dashboard.state.kept import short
from railjoule.dashboard.state.numbers import TypedInteger, TypedParameters
from railjoule.dashboard.state.page_model import PageModel, result

FIRST_RUNS, MOST_RUNS = 3000, 2_000_000
COLUMNS = (*DEFAULT_COLUMNS, "max_speed_kmh")
"""What a study of this page tells of each run."""
ROWS_AT_ONCE = 50
State = Literal["none", "waiting", "running", "stopping", "stopped", "failed", "done"]
UNDER_WAY = "waiting", "running", "stopping"
Ranges = Mapping[str, list[float]]


@dataclass(frozen=True, eq=False)
class Saved:
    """A file that the browser may fetch once.

    Parameters
    ----------
    place : str
        Its address, from that of the page.
    name : str
        What it is called there.
    """

    place: str
    name: str


@dataclass(frozen=True, eq=False)
class Brought:
    """The file of a study from the user's disk.

    Parameters
    ----------
    name : str
        The name of the file.
    content : bytes
    """

    name: str
    content: bytes


@dataclass(frozen=True)
class Progress:
    """How far a study is.

    Parameters
    ----------
    state : str
    done, runs : int
        How many of its runs are done.
    per_s : float or None
        Runs in a second [1/s], once that is known.
    told : str
        What is to be said of it, such as why it ended.
    """

    state: State = "none"
    done: int = 0
    runs: int = 0
    per_s: float | None = None
    told: str = ""

    @property
    def left_s(self) -> float | None:
        """How long the rest takes [s], if that is known."""
        return (self.runs - self.done) / self.per_s if self.per_s else None

    @property
    def is_under_way(self) -> bool:
        """Whether it runs, or waits to."""
        return self.state in UNDER_WAY


class StudyModel(TypedParameters, PageModel):
    """The settings of the page and its results; ranges are in the units of the scenario's file."""

    kept = ("over", "method", "strategy", "runs", "seed", "x", "y", "colour", "map_x", "map_y")
    passing = ("choice", "shown", "refusal", "refused", "may_go_on", "saving")

    over = param.Dict(default={}, doc="What varies, by its key in the file: from where to where.")
    method = param.Selector(default="sobol", objects=list(METHODS), doc="How the runs are drawn.")
    strategy = param.Selector(default="optimal", objects=list(STRATEGIES), doc="Who makes the runs.")
    runs = TypedInteger("Runs", default=FIRST_RUNS, bounds=(1, MOST_RUNS))
    seed = TypedInteger("Seed", default=1, bounds=(0, 2**31))
    x = param.String(default="", doc="What lies to the right; empty for the first field.")
    y = param.String(default=ENERGY, doc="What lies upwards.")
    colour = param.String(default="", doc="What the colours tell; empty for the second field.")
    map_x = param.String(default="", doc="What lies to the right in the map; empty for the field that decides most.")
    map_y = param.String(default="", doc="What lies upwards in the map; empty for the field that decides next.")

    current = result(EstimateRequest, "The study that these settings ask for.")
    asked = result(EstimateRequest, "The settings of the study that is shown; none where it was opened from a file.")
    study = result(Study, "What is shown.")
    progress = param.ClassSelector(class_=Progress, default=Progress(), doc="How far it is.")
    look = result(Look, "What is drawn of it.")
    drawn = result(object, "The figures, where they are others than before.")
    saved = result(Saved, "The file that was written for the browser last.")
    estimate = result(Estimate, "How long the study asked for takes.")
    choice = param.Dict(default={}, doc="What is chosen: from where to where, by column.")
    shown = param.Integer(default=ROWS_AT_ONCE, doc="How many of the chosen runs are listed.")
    refusal = param.String(default="", doc="Why a study was not begun or opened.")
    refused = param.Dict(default={}, doc="Why a range was not taken, by the field's key.")
    may_go_on = param.Boolean(default=True, doc="Whether a study that has stopped can go on.")
    saving = param.Boolean(default=False, doc="Whether a file is being written for the browser.")
    # what is asked of the work
    start = param.Event(doc="Begin.")
    stop = param.Event(doc="Stop; what is done stays.")
    resume = param.Event(doc="Go on.")
    wanted_file = result(str, "The suffix of the file that is to be written for the browser.")
    wanted_run = result(int, "The number of the run that is to be opened on Drive.")
    brought = result(Brought, "The file of a study that is to be opened.")

    def __init__(self, scenario: Scenario, **params: Any) -> None:
        super().__init__(**params)
        self.take(scenario)

    def take(self, scenario: Scenario) -> None:
        """Begin with the ranges of a scenario."""
        self.param.update(over=first_ranges(scenario), strategy=scenario.strategy, refused={}, refusal="")

    def checked(self, field: str, value: Any) -> Any:
        """Return a value as `Kept.checked` does; of ranges each is looked at."""
        value = super().checked(field, value)
        if field == "over":
            if len(value) > MOST_VARIED:
                raise ValueError(f"must have at most {MOST_VARIED} fields")
            for path, ends in value.items():
                if not _is_range(ends):
                    raise ValueError(f"has {short(path)}, which must have two finite numbers")
        return value

    def set_range(self, scenario: Scenario, path: str, low: str, high: str) -> None:
        """Take a range that was typed, or say why not; what cannot be taken leaves all as it is."""
        known = fields_that_vary(scenario)
        if path not in self.over or path not in known:
            return
        field = known[path].declared
        try:
            ends = [_number(field, text) for text in (low, high)]
            if ends[0] > ends[1]:
                raise ValueError(f"The range {low.strip()} to {high.strip()} begins above its end.")
        except ValueError as refusal:
            self.refused = {**self.refused, path: str(refusal)}
            return
        refused = {key: told for key, told in self.refused.items() if key != path}
        self.param.update(over={**self.over, path: ends}, refused=refused)

    def add(self, scenario: Scenario, path: str) -> None:
        """Let one more field vary."""
        known = fields_that_vary(scenario)
        if path in known and path not in self.over and len(self.over) < MOST_VARIED:
            self.over = {**self.over, path: list(known[path].first_range)}

    def remove(self, path: str) -> None:
        """Let a field no longer vary."""
        refused = {key: told for key, told in self.refused.items() if key != path}
        over = {key: ends for key, ends in self.over.items() if key != path}
        self.param.update(over=over, refused=refused)

    @property
    def columns(self) -> tuple[str, ...]:
        """All columns of the study that is shown: what varies, then what came out."""
        return () if self.study is None else (*(field.name for field in self.study.fields), *self.study.columns)

    def axes(self) -> tuple[str, str, str]:
        """Return what lies to the right, upwards and in the colours, of the study that is shown."""
        columns = self.columns
        fields = [name for name in columns if name not in RESULTS]
        x = self.x if self.x in columns else fields[0]
        y = self.y if self.y in columns else ENERGY
        colour = self.colour if self.colour in columns else fields[min(1, len(fields) - 1)]
        return x, y, colour

    def map_axes(self) -> tuple[str, str]:
        """Return the fields of the map: those that were chosen, else the ones that decide most."""
        fields = [name for name in self.columns if name not in RESULTS]
        ranked = fields
        if self.look is not None and self.look.shares is not None:
            ranked = [name for name in self.look.shares.fields if name in fields] or fields
        x = self.map_x if self.map_x in fields else ranked[0]
        others = [name for name in (self.map_y, *ranked) if name in fields and name != x]
        return x, others[0] if others else x


def _number(field: Field, text: str) -> float:
    """Return the number that a text gives for a field; raises ValueError with a sentence that names field and bound."""
    # a field that may be left out takes an empty text for nothing
    found = field.parse(text) if text.strip() else None
    if found is None:
        raise ValueError("Not a number.")
    return float(found)


def _is_range(ends: Any) -> bool:
    numbers = isinstance(ends, list) and len(ends) == 2 and all(type(end) in {int, float} for end in ends)
    return numbers and all(map(math.isfinite, ends))
