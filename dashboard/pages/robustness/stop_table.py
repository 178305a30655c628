"""Where the train stops with errors of measurement: with precision braking and without it, as a table."""

from collections.abc import Callable

from railjoule.core.studies.braking_sensors import MEASUREMENTS, BrakingSensors
from railjoule.dashboard.look import words
from railjoule.dashboard.parts import html as parts

HEADER = ("Error", "by itself", "Stop with sensors, m", "without, m")


def _metres(value: float) -> str:
    return f"{words.stop_error(value)} m"


NAMES: dict[str, tuple[str, Callable[[float], str]]] = {
    "coordinate_error_m": ("Position at the start", _metres),
    "speed_error": ("Measured speed", lambda value: f"{words.signed(100 * value, 2)} %"),
    "d1_error_m": ("Place of D1 (L_pb)", _metres),
    "d2_error_m": ("Place of D2 (L_c)", _metres),
    "d3_error_m": ("Place of D3 (L_st)", _metres),
}
"""Each error of measurement in words, and how a value of it reads."""


def stop_table(study: BrakingSensors) -> str:
    """Return the stopping errors of each error by itself, then of all of them drawn together."""
    rows = [(_row(study, name), False) for name in MEASUREMENTS]
    both = study.spread_with, study.spread_without
    within = (words.number(spread.half_width_m, 2) for spread in both)
    deviation = (words.number(spread.deviation_m, 2) for spread in both)
    rows.append((("All drawn: 95 % stop within", "", *within), True))
    rows.append((("All drawn: standard deviation", "", *deviation), False))
    note = (
        f"{words.number(len(study.with_m), 0)} runs, seed {study.scenario.montecarlo.seed}; each error by itself at "
        "the ends of the middle 95 % of its draws. Without sensors the train stops where it estimates the stop."
    )
    return parts.inset(parts.table("Precision braking: stopping error", HEADER, rows), parts.note_paragraphs([note]))


def _row(study: BrakingSensors, name: str) -> tuple[str, ...]:
    word, show = NAMES[name]
    low, high = (effect for effect in study.effects if effect.quantity == name)
    errors = (low.with_m, high.with_m), (low.without_m, high.without_m)
    pairs = [(show(low.value), show(high.value))]
    pairs += [(words.stop_error(least), words.stop_error(most)) for least, most in errors]
    return (word, *(" / ".join(pair) for pair in pairs))
