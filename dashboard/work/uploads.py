"""What may be sent to the server as the file of a measured run."""

from railjoule.dashboard.limits import LARGEST_RUN_BYTES

RUN_SUFFIXES = (".csv", ".tsv", ".txt", ".xlsx")


def too_large(name: str) -> str:
    """Return why a file of this name is not read."""
    return f"{name}: larger than the {LARGEST_RUN_BYTES / 1e6:g} MB that a run may have."
