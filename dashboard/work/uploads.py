"""Bounds of the files of lines, trains, runs and studies that are sent to the server."""

from railjoule.dashboard.limits import LARGEST_RUN_BYTES

STUDIES = (".nc",)
FILE_SUFFIXES = (".csv", ".tsv", ".txt", ".xlsx", ".json")
"""Endings of the names of files of lines, trains and runs."""


def too_large(name: str) -> str:
    """Return why a file of this name is not read."""
    return f"{name}: larger than the {LARGEST_RUN_BYTES / 1e6:g} MB that a file may have."


def large_study(name: str) -> str:
    """Return why a dropped study is not read, and the way to open it."""
    limit = f"{LARGEST_RUN_BYTES / 1e6:g} MB"
    return (
        f"{name}: larger than the {limit} that can be dropped; \u201cOpen a study\u201d on Explore reads larger ones."
    )
