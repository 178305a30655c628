"""In words, by what two scenarios differ."""

from collections.abc import Callable, Mapping
from typing import Any

from railjoule.core import Scenario
from railjoule.core.scenario.scenario import TIME_KEYS
from railjoule.dashboard.look import words
from railjoule.dashboard.look.key_names import split_unit, words_of

MAX_SENTENCES = 6
"""At most so many differences are listed one by one."""
WHOLES = ("vehicle", "line")
"""Tables that are named as a whole where they come from different presets or files."""
QUANTITIES: Mapping[str, tuple[str, Callable[[Any], str]]] = {
    "timetable.travel_time_s": ("travel time", lambda s: f"{words.time(s)} s"),
    "vehicle.load_factor": ("load", lambda share: f"{words.setting(share)} %"),
    "vehicle.load_t": ("load", lambda tonnes: "by its share" if tonnes is None else f"{words.setting(tonnes / 100)} t"),
    "vehicle.drive.recuperation_factor": ("recuperation", lambda share: f"{words.setting(share)} %"),
    "enoc.acceleration_time_s": ("ENOC\u2019s acceleration time", lambda s: f"{words.time(s)} s"),
    "line.reverse": ("run in reverse", lambda on: "yes" if on else "no"),
}
"""Keys of the file that have words of their own."""
# what others tell: average speed and reserve as travel time, the presets by the names of their tables
TIMES = tuple(f"timetable.{key}" for key in (*TIME_KEYS[1:], "reserve_parts"))
NOT_TOLD = ("title", "strategy", *TIMES, "vehicle.preset", "line.preset")


def difference_words(scenario: Scenario, reference: Scenario) -> tuple[str, ...]:
    """Return by what a scenario differs from another one, such as 'load 70 % instead of 50 %'; empty if by nothing."""
    now, before = _flat(scenario), _flat(reference)
    sentences: list[str] = []
    skipped: tuple[str, ...] = ()
    for whole in WHOLES:
        one, other = _name(scenario, whole), _name(reference, whole)
        if one != other:
            sentences.append(f"{whole} {one} instead of {other}")
            skipped += (f"{whole}.",)
    keys = [key for key in {**QUANTITIES, **now, **before} if now.get(key) != before.get(key)]
    told = [key for key in keys if key in QUANTITIES or not key.startswith((*skipped, *NOT_TOLD))]
    sentences += [_sentence(key, now.get(key), before.get(key)) for key in told]
    more = len(sentences) - MAX_SENTENCES
    if more > 0:
        sentences = [*sentences[:MAX_SENTENCES], f"and {more} more"]
    return tuple(sentences)


def _flat(scenario: Scenario) -> dict[str, Any]:
    """Return all keys of a scenario by their dotted paths, lists whole, the travel time however it was given."""
    flat: dict[str, Any] = {}

    def walk(table: Mapping[str, Any], path: str) -> None:
        for key, value in table.items():
            if isinstance(value, Mapping):
                walk(value, f"{path}{key}.")
            else:
                flat[path + key] = value

    walk(scenario.model_dump(mode="json"), "")
    # to a microsecond: one that follows from an average speed has errors of rounding
    flat["timetable.travel_time_s"] = round(scenario.travel_time_s, 6)
    return flat


def _name(scenario: Scenario, whole: str) -> str:
    part = scenario.vehicle if whole == "vehicle" else scenario.line
    return part.name or part.preset or "unnamed"


def _sentence(key: str, now: Any, before: Any) -> str:
    if key in QUANTITIES:
        word, show = QUANTITIES[key]
        return f"{word} {_shown(show, now)} instead of {_shown(show, before)}"
    word, unit = _quantity(key)
    if isinstance(now, list) or isinstance(before, list):
        return f"different {word}"
    values = (f"{_shown(_plain, value)}{f' {unit}' if unit and value is not None else ''}" for value in (now, before))
    return f"{word} {' instead of '.join(values)}"


def _quantity(key: str) -> tuple[str, str]:
    """Return the quantity of a key in lower case, after that of its own table within a table, and its unit."""
    _, *tables, name = key.split(".")
    name, unit = split_unit(name)
    return " ".join(words_of(part).lower() for part in (*tables, name)), unit


def _shown(show: Callable[[Any], str], value: Any) -> str:
    return "none" if value is None else show(value)


def _plain(value: Any) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:g}".replace("-", words.MINUS) if isinstance(value, int | float) else str(value)
