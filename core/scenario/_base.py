"""What all parts of a scenario share: frozen values, strict numbers, known keys only."""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

# strict: a text or a boolean where a number belongs is a slip of the pen, and pydantic would turn both into numbers. A
# NaN or an infinity would only show far away, as a solver that does not converge.
Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
"""A finite number; text, booleans, NaN and infinity are refused."""

Count = Annotated[int, Field(strict=True)]
"""A whole number."""


class Part(BaseModel):
    """A frozen, validated table of a scenario file; an unknown key is an error."""

    # A misspelt key that was ignored would leave a default in force without a word. The input stays out of errors
    # because `_sentences` shows it itself, and shortened.
    model_config = ConfigDict(frozen=True, extra="forbid", hide_input_in_errors=True)
