"""Where the sample files of TTOBench lie beside this project, for tests and tables that read them."""

from pathlib import Path

FOLDER = Path(__file__).parents[2] / "shared" / "ttobench" / "ttobench-v1.5"
TRACKS, TRAINS = FOLDER / "tracks", FOLDER / "trains"
ABSENT = "the sample files of TTOBench do not lie beside this project"


def track_names() -> list[str]:
    """Return the names of all tracks, none where the samples are absent."""
    return sorted(path.stem for path in TRACKS.glob("*.json"))


def train_names() -> list[str]:
    """Return the names of all trains, none where the samples are absent."""
    return sorted(path.stem for path in TRAINS.glob("*.json"))
