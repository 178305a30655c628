"""Base of all parts of a scenario: frozen values, strict numbers, known keys only."""

import unicodedata
from collections.abc import Iterable, Mapping
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError

from railjoule.core.errors import ScenarioError

# strict: a text or a boolean where a number belongs is a slip of the pen, and pydantic would turn both into numbers. A
# NaN or an infinity would only show far away, as a solver that does not converge.
Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
"""A finite number; text, booleans, NaN and infinity are refused."""

Count = Annotated[int, Field(strict=True)]
"""A whole number."""


TURNING = frozenset("\u061c\u200e\u200f\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069")
"""Signs without a shape of their own that turn the direction in which the text around them reads."""


def is_misleading(sign: str) -> bool:
    """Return whether a sign is no text: one that controls, that ends a line, or that turns the text around it."""
    return sign in TURNING or unicodedata.category(sign) in {"Cc", "Zl", "Zp"}


def without_misleading(text: str) -> str:
    """Return a text from outside in a form that can be shown: signs that are no text become visible marks."""
    return "".join("\ufffd" if is_misleading(sign) else sign for sign in text)


def _require_plain(text: str) -> str:
    wrong = next((sign for sign in text if is_misleading(sign)), None)
    if wrong is not None:
        raise ValueError(f"has the sign U+{ord(wrong):04X}, which is no text and can change how a name reads")
    return text


Name = Annotated[str, AfterValidator(_require_plain)]
"""A text on one line that reads as it is written."""


class Part(BaseModel):
    """A frozen, validated table of a scenario file; an unknown key is an error."""

    def __init__(self, **fields: Any) -> None:
        try:
            super().__init__(**fields)
        except ValidationError as error:
            raise _construction_error(type(self), fields, error) from None

    # pydantic looks at this flag: a model within a model is then validated without this constructor, and its errors
    # keep their place
    __init__.__pydantic_base_init__ = True  # type: ignore[attr-defined]

    # A misspelt key that was ignored would leave a default in force without a word. The input stays out of errors
    # because `_sentences` shows it itself, and shortened.
    model_config = ConfigDict(frozen=True, extra="forbid", hide_input_in_errors=True)


class PresetPart(Part):
    """A table that may be based on a shipped one."""

    preset_kind: ClassVar[Literal["vehicles", "lines"]]
    preset: str | None = Field(None, description="Name of the shipped preset that this one is based on.")

    @classmethod
    def from_preset(cls, name: str, **changes: Any) -> Self:
        """Return a shipped vehicle or line.

        Parameters
        ----------
        name : str
            Name of the preset; `railjoule.preset_names("vehicles")` and `("lines")` list them.
        **changes
            Keys to change, such as `load_factor=0.3`, `reverse=True` or `drive={"recuperation_factor": 0.4}`.

        Raises
        ------
        ScenarioError
            If there is no such preset, or a key or its value is wrong.
        """
        # documents import the parts
        from railjoule.core.scenario.document import part_from_preset  # noqa: PLC0415

        return part_from_preset(cls, name, changes)


def _construction_error(part: type[Part], fields: Mapping[str, Any], error: ValidationError) -> ScenarioError:
    """Return the error of a constructor as one sentence."""
    # `_sentences` imports the parts, which inherit from the class above
    from railjoule.core.scenario._sentences import describe_findings  # noqa: PLC0415

    name, preset = part.__name__, fields.get("preset")
    if preset is not None and any(finding["type"] == "missing" for finding in error.errors()):
        return ScenarioError(
            f"{name}(preset={preset!r}) needs all other keys; {name}.from_preset({preset!r}) fills them in."
        )
    return ScenarioError(describe_findings(error, part, name))


def require_effect(part: Part, keys: Iterable[str], reason: str) -> None:
    """Raise ValueError for a key with another value than its default in a table where it has no effect.

    Parameters
    ----------
    part : Part
        The table.
    keys : iterable of str
        Keys that nothing reads beside the other values of the table.
    reason : str
        Why, as the end of a sentence.
    """
    for key in keys:
        value = getattr(part, key)
        if value != type(part).model_fields[key].default:
            shown = f"{value:g}" if isinstance(value, float) else str(value).lower()
            raise ValueError(f"{key} = {shown} has no effect {reason}")
