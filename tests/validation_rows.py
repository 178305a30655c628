"""Rows of validation tables, held to a bar."""

from collections.abc import Iterable

from railjoule.core.validation import Row


def beyond(percent: float, rows: Iterable[Row]) -> dict[str, float | None]:
    """Return by how much the rows differ that differ by a bar or more [%], by case and quantity; there must be some."""
    held = list(rows)
    assert held, "there are no rows"
    return {
        f"{row.case}, {row.quantity}": row.difference_percent
        for row in held
        if row.difference_percent is None or abs(row.difference_percent) >= percent
    }
