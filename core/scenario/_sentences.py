"""Turn pydantic's findings into one sentence that names key, value and bound."""

import difflib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, TypeVar, get_args

from pydantic import BaseModel, ValidationError

from railjoule.core.errors import ScenarioError
from railjoule.core.scenario.options import MonteCarloOptions

# Pydantic's own sentences name neither the key as the file has it nor always the value, so each of its kinds of error
# has words here; `_finding` uses its own sentence for others.
WORDS = {
    "missing": "{path} is missing",
    "greater_than": "{path} = {value} must be above {gt:g}",
    "greater_than_equal": "{path} = {value} must be at least {ge:g}",
    "less_than": "{path} = {value} must be below {lt:g}",
    "less_than_equal": "{path} = {value} must be at most {le:g}",
    **dict.fromkeys(("float_type", "float_parsing"), "{path} = {value} must be a number"),
    "finite_number": "{path} = {value} must be a finite number",
    **dict.fromkeys(("int_type", "int_from_float"), "{path} = {value} must be a whole number"),
    "bool_type": "{path} = {value} must be true or false",
    "string_type": "{path} = {value} must be a text",
    "tuple_type": "{path} = {value} must be a list",
    **dict.fromkeys(("model_type", "model_attributes_type", "dict_type"), "{path} = {value} must be a table"),
    "literal_error": "{path} = {value} must be {expected}",
    "union_tag_invalid": "{path}.{tag_key} = {shown_tag} must be one of {expected_tags}",
    "union_tag_not_found": "{path}.{tag_key} is missing",
    "too_short": "{path} has fewer than {min_length} entries",
    "too_long": "{path} has more than {max_length} entries",
    "string_too_long": "{path} is longer than {max_length} characters",
}
# in a file the drive is a table of its own, in the model a part of the vehicle
ALIASES = {"vehicle.drive": "drive"}
TAG_KEYS = ("model", "distribution")
"""Keys that tell the kind of a table."""
TAGGED_TABLES = {"drive", *MonteCarloOptions.model_fields}
"""Tables that have a key for their kind."""
LONGEST_SHOWN = 60
# Larger, and every misspelling would have two proposals; smaller, and of two keys that differ only in their unit just
# one would be named.
SECOND_MATCH_MARGIN = 0.18
"""A second name is proposed where its likeness is less than this below that of the first."""
# Python refuses to print integers of more than 4300 digits, some 14,000 bits; a file may hold one all the same.
LONGEST_INTEGER_BITS = 4096


Model = TypeVar("Model", bound=BaseModel)


def validated(model: type[Model], document: Any, source: str) -> Model:
    """Validate a document of a file as a model.

    Raises
    ------
    ScenarioError
        If a key is unknown or missing, or a value wrong: one sentence that begins with `source`.
    """
    try:
        return model.model_validate(document)
    except ValidationError as error:
        raise ScenarioError(describe_findings(error, model, source)) from None


def describe_findings(error: ValidationError, model: type[BaseModel], source: str) -> str:
    """Describe the first finding of `error` in one sentence, with the number of the others."""
    everything = error.errors(include_url=False)
    findings = [finding for finding in everything if not _is_consequence(finding, everything)]
    # a misspelt key is reported before the key that is therefore missing
    first = next((finding for finding in findings if finding["type"] == "extra_forbidden"), findings[0])
    # the others are counted and not listed: one mistake is repaired at a time, and most of the others follow from it
    text = f"{source}: {_finding(first, model)}"
    others = len(findings) - 1
    return text + (f" (and {others} more)." if others else "" if text.endswith("?") else ".")


def _is_consequence(finding: Mapping[str, Any], findings: Sequence[Mapping[str, Any]]) -> bool:
    """Return whether a list is only found too short because its entries are wrong."""
    place = finding["loc"]
    return finding["type"] == "too_short" and any(
        len(other["loc"]) > len(place) and other["loc"][: len(place)] == place for other in findings
    )


def suggestion(name: str, known: Iterable[str]) -> str:
    """Return 'did you mean ...?' or a list of what is known, for an unknown `name`."""
    # sorted, so that equal likenesses come in the same order each time
    names = sorted(known)
    close = difflib.get_close_matches(name, names, n=2, cutoff=0.6)
    likeness = [difflib.SequenceMatcher(None, name, match).ratio() for match in close]
    close = [match for match, ratio in zip(close, likeness, strict=True) if ratio > likeness[0] - SECOND_MATCH_MARGIN]
    if close:
        return "did you mean " + " or ".join(repr(match) for match in close) + "?"
    return "choose one of " + ", ".join(names)


def show(value: Any) -> str:
    """Return a short text of any value that a user may have written."""
    if isinstance(value, int) and value.bit_length() > LONGEST_INTEGER_BITS:
        return "a number of very many digits"  # Python refuses to write it down
    return shorten(f"{value:g}" if isinstance(value, float) else repr(value))


def shorten(text: str) -> str:
    """Return a text, of a long one its beginning."""
    return text if len(text) <= LONGEST_SHOWN else text[: LONGEST_SHOWN - 3] + "..."


def counted(count: int, what: str) -> str:
    """Format a number of things: '1 row' or '3 rows'."""
    return f"{count} {what}{'' if count == 1 else 's'}"


def shown_list(names: Iterator[str] | list[str], most: int = 8) -> str:
    """Join names by commas, of a long list or name the beginning."""
    names = [shorten(name) for name in names]
    more = len(names) - most
    return ", ".join(names[:most]) + (f" and {more} more" if more > 0 else "")


def _finding(finding: Mapping[str, Any], model: type[BaseModel]) -> str:
    place, kind = finding["loc"], finding["type"]
    # pydantic puts the tag of a union into the place, "drive.induction.motors", where the file has "drive.motors"
    location = _without_tags(place)
    path, value, context = _dotted(location), show(finding["input"]), finding.get("ctx", {})
    if kind == "extra_forbidden":
        return f"unknown key {path}, {suggestion(str(location[-1]), _keys_at(model, place[:-1]))}"
    if kind == "too_short" and context["min_length"] == 1:
        return f"{path} is empty"
    if kind == "value_error":
        # of our own checks on a table, some name a key of it
        words = str(context["error"])
        begins_with_key = any(words.startswith(key) for key in _keys_at(model, place))
        return f"{path}{'.' if begins_with_key else ' '}{words}" if path else words
    tag = {"tag_key": str(context.get("discriminator")).strip("'"), "shown_tag": show(context.get("tag"))}
    return WORDS.get(kind, "{path} = {value}: {msg}").format_map(
        {**finding, **context, **tag, "path": path, "value": value}
    )


def _without_tags(location: Sequence[str | int]) -> list[str | int]:
    """Drop the names of drive models and distributions, which are no keys of the file."""
    return [part for index, part in enumerate(location) if not (index and location[index - 1] in TAGGED_TABLES)]


def _dotted(location: Sequence[str | int]) -> str:
    text = ""
    for part in location:
        name = part if isinstance(part, int) else shorten(part)
        text += f"[{name}]" if isinstance(name, int) else f".{name}" if text else name
    for inner, outer in ALIASES.items():
        if text.startswith(inner + "."):
            text = outer + text[len(inner) :]
    return text


def _keys_at(model: type[BaseModel], location: Sequence[str | int]) -> set[str]:
    """Return the keys that the table at `location` may have."""
    models = [model]
    for part in location:
        if isinstance(part, str):
            inside = [
                inner
                for outer in models
                if part in outer.model_fields
                for inner in _models_in(outer.model_fields[part].annotation)
            ]
            # a part that is no field is the tag of a union: it chooses among the models found so far
            models = inside or [one for one in models if _is_tagged(one, part)]
    return {name for known in models for name in known.model_fields}


def _is_tagged(model: type[BaseModel], tag: str) -> bool:
    """Tell the drive model or distribution of a name from the others."""
    fields = [model.model_fields[name] for name in TAG_KEYS if name in model.model_fields]
    return any(tag in get_args(field.annotation) for field in fields)


def _models_in(annotation: Any) -> list[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [model for inner in get_args(annotation) for model in _models_in(inner)]
