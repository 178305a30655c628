"""Files of TTOBench, a library of tracks, trains and journeys for train trajectory optimisation."""

from railjoule.core.imports.ttobench.scenario import ImportedScenario, read_ttobench
from railjoule.core.imports.ttobench.track import read_track
from railjoule.core.imports.ttobench.train import ImportedTrain, read_train

__all__ = [
    "ImportedScenario",
    "ImportedTrain",
    "read_track",
    "read_train",
    "read_ttobench",
]
