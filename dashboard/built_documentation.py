"""The folder of the built documentation: the server answers from it, and the page Help links to it if it is there."""

from pathlib import Path

# an editable install maps each file by a link; an installed package has no such folder
FOLDER = Path(__file__).resolve().parents[1] / "build" / "docs"
"""The folder in a checkout that `./run docs` writes to."""
FRONT = "index.html"


def is_built(folder: Path | str = FOLDER) -> bool:
    """Return whether a folder has the front page of the documentation."""
    return (Path(folder) / FRONT).is_file()
