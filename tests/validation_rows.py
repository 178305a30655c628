"""Rows of validation tables, picked and held to a bar."""

from collections.abc import Iterator
from typing import Any

from railjoule.core.validation import Row, Table


def printed_rows(*tables: Table, **wanted: Any) -> Iterator[Row]:
    """Yield the rows that have a printed number and are as wanted; raises AssertionError where there is none."""
    found = [
        row
        for table in tables
        for row in table.rows
        if row.printed and all(getattr(row, name) == value for name, value in wanted.items())
    ]
    assert found, f"no row with {wanted}"
    yield from found


def beyond(percent: float, rows: Iterator[Row]) -> dict[str, float | None]:
    """Return by how much the rows differ that differ by a bar or more [%], by case and quantity."""
    return {
        f"{row.case}, {row.quantity}": row.difference_percent
        for row in rows
        if row.difference_percent is None or abs(row.difference_percent) >= percent
    }
