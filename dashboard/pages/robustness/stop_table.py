"""The stopping place with errors of measurement, with precision braking and without it, as a table."""

from collections.abc import Callable

from railjoule.core.studies.braking_sensors import MEASUREMENTS, BrakingSensors
from railjoule.dashboard.look import words
from railjoule.dashboard.parts import html as parts

HEADER = ("Error", "Value", "With sensors, m", "Without, m")


def _metres(value: float) -> str:
    return f"{words.stop_error(value)} m"


NAMES: dict[str, tuple[str, Callable[[float], str]]] = {
    "coordinate_error_m": ("Position", _metres),
    "speed_error": ("Speed", lambda value: f"{words.signed(100 * value, 2)} %"),
    "d1_error_m": ("D1 (L_pb)", _metres),
    "d2_error_m": ("D2 (L_c)", _metres),
    "d3_error_m": ("D3 (L_st)", _metres),
}
"""Each error of measurement in words, and how a value of it reads."""


def stop_table(study: BrakingSensors) -> str:
    """Return the stopping errors of each error by itself, then of all of them drawn together."""
    rows = [(_row(study, name), False) for name in MEASUREMENTS]
    both = study.spread_with, study.spread_without
    within = (words.number(spread.half_width_m, 2) for spread in both)
    deviation = (words.number(spread.deviation_m, 2) for spread in both)
    rows.append((("All, 95 % within", "", *within), True))
    rows.append((("All, deviation", "", *deviation), False))
    runs, seed = words.number(study.table.done, 0), study.table.scenario.montecarlo.seed
    note = (
        f"{runs} runs, seed {seed}; each error by itself at the upper end of the middle 95 % of its draws, then "
        "all drawn together. Without sensors the train stops where it estimates the stop."
    )
    return parts.inset(parts.table("Precision braking: stopping error", HEADER, rows), parts.note_paragraphs([note]))


def _row(study: BrakingSensors, name: str) -> tuple[str, ...]:
    word, show = NAMES[name]
    # the upper end of the middle of its draws: the lower one gives the same with the other sign
    _, effect = (effect for effect in study.effects if effect.quantity == name)
    return word, show(effect.value), words.stop_error(effect.with_m), words.stop_error(effect.without_m)
