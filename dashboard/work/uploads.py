"""Bounds of the files of measured runs and studies that are sent to the server."""

from railjoule.dashboard.limits import LARGEST_RUN_BYTES

RUN_SUFFIXES = (".csv", ".tsv", ".txt", ".xlsx")


def too_large(name: str) -> str:
    """Return why a file of this name is not read."""
    return f"{name}: larger than the {LARGEST_RUN_BYTES / 1e6:g} MB that a run may have."


def large_study(name: str) -> str:
    """Return why a dropped study is not read, and the way to open it."""
    limit = f"{LARGEST_RUN_BYTES / 1e6:g} MB"
    return (
        f"{name}: larger than the {limit} that can be dropped; \u201cOpen a study\u201d on Explore reads larger ones."
    )
