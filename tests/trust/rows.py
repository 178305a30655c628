"""Rows of the table of trust: what was found before, what is found now, and whether that is good."""

import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass


@dataclass(frozen=True)
class Found:
    """What a row finds now, in a few words, and whether it is as it must be."""

    words: str
    good: bool


@dataclass(frozen=True)
class Row:
    """One line of the table.

    Parameters
    ----------
    section : str
        Of the review, shared/review/trust.md, whose table it repeats.
    name : str
        What is tried.
    before : str
        What the review of 22 Nov 2026 found.
    find : callable
        Tries it.
    quick : bool
        Whether the gate tries it too.
    """

    section: str
    name: str
    before: str
    find: Callable[[], Found]
    quick: bool = True


def outcome(row: Row) -> Found:
    """Return what a row finds; an error is a finding, and not a good one."""
    try:
        return row.find()
    except Exception as error:
        return Found(f"{type(error).__name__}: {error}"[:160], False)


def table(rows: Iterable[Row], tell: Callable[[str], None]) -> bool:
    """Try rows one after the other, tell each as a line of a table, and return whether all are good."""
    good = True
    tell("| section | row | before (trust.md) | now | verdict |")
    tell("| --- | --- | --- | --- | --- |")
    for row in rows:
        started = time.monotonic()
        found = outcome(row)
        good &= found.good
        words = found.words.replace("|", "/").replace("\n", " ")
        told = f"{words} ({time.monotonic() - started:.1f} s) | {'good' if found.good else 'FAULT'}"
        tell(f"| {row.section} | {row.name} | {row.before} | {told} |")
    return good
