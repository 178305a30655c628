"""The state of one open page: its scenario, what it shows, what was computed, what is pinned."""

from typing import Any

import param

from railjoule.core import RailjouleError, Trajectory
from railjoule.core.scenario import StrategyName
from railjoule.core.strategies import STRATEGIES
from railjoule.dashboard.models.disturbances import DisturbancesModel
from railjoule.dashboard.models.editor import EditorModel
from railjoule.dashboard.models.robustness import RobustnessModel
from railjoule.dashboard.models.scenario import ScenarioModel
from railjoule.dashboard.models.speed_limits import SpeedLimitsModel
from railjoule.dashboard.store import Runs, TradeOff

PAGES = ("Drive", "Trade-off", "Robustness", "Disturbances", "Speed limits")


class Workbench(param.Parameterized):
    """Everything that the views of one open page draw; they write to it, and the store fills in the results."""

    page = param.Selector(default="Drive", objects=list(PAGES), doc="The page in sight.")
    ticked = param.ListSelector(default=["optimal", "fastest"], objects=list(STRATEGIES), doc="Strategies drawn.")
    chosen = param.Selector(default="optimal", objects=list(STRATEGIES), doc="The strategy whose numbers are shown.")
    over_time = param.Boolean(default=False, doc="Draw over time instead of distance.")
    dark = param.Boolean(default=False, doc="Dark colours.")
    runs = param.ClassSelector(class_=Runs, default=None, allow_None=True, doc="The last good runs.")
    trade_off = param.ClassSelector(class_=TradeOff, default=None, allow_None=True, doc="The last good trade-off.")
    trade_off_duration_s = param.Number(default=0.0, doc="How long its computation took.")
    wide_map = param.Boolean(default=False, doc="Show ENOC's map up to 5000 s.")
    copper_weight = param.Number(default=1.0, doc="Copper loss of ENOC's map over the vehicle's own.")
    pinned = param.ClassSelector(class_=Trajectory, default=None, allow_None=True, doc="The run to compare with.")
    failure = param.ClassSelector(
        class_=RailjouleError, default=None, allow_None=True, doc="Why the last wish could not be met."
    )

    def __init__(self, **params: Any) -> None:
        self.scenario = ScenarioModel()
        self.editor = EditorModel(self.scenario)
        self.robustness = RobustnessModel()
        self.disturbances = DisturbancesModel()
        self.speed_limits = SpeedLimitsModel()
        super().__init__(**params)
        self.scenario.param.watch(self._take_strategy, ["preset", "opened"])

    def _take_strategy(self, *_: Any) -> None:
        """Show the strategy that a scenario's file names."""
        if self.scenario.base.strategy in STRATEGIES:
            self.chosen = self.scenario.base.strategy

    @property
    def drawn(self) -> tuple[StrategyName, ...]:
        """The strategies to draw and to compute, the one whose numbers are shown included."""
        return tuple(name for name in STRATEGIES if name in self.ticked or name == self.chosen)

    @property
    def chosen_now(self) -> StrategyName:
        """The strategy whose numbers are shown: the optimum where the chosen one refuses the scenario."""
        chosen: StrategyName = self.chosen
        if self.runs is None or chosen in self.runs.runs:
            return chosen
        return next(name for name, run in self.runs.runs.items() if run is self.runs.best)

    @property
    def run(self) -> Trajectory | None:
        """The run whose numbers are shown."""
        return None if self.runs is None else self.runs.runs[self.chosen_now]

    @property
    def stale(self) -> bool:
        """Whether what is shown is the last good run, not the one asked for."""
        return self.failure is not None
