"""Files of TTOBench, a library of tracks, trains and journeys for train trajectory optimisation."""

from railjoule.core.imports.ttobench.track import ImportedScenario, read_track, read_ttobench
from railjoule.core.imports.ttobench.train import ImportedTrain, read_train

__all__ = [
    "ImportedScenario",
    "ImportedTrain",
    "read_track",
    "read_train",
    "read_ttobench",
]
