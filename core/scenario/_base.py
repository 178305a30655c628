"""What all parts of a scenario share: frozen values, strict numbers, known keys only."""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
"""A finite number; text, booleans, NaN and infinity are refused."""

Count = Annotated[int, Field(strict=True)]
"""A whole number."""


class Part(BaseModel):
    """A frozen, validated table of a scenario file; an unknown key is an error."""

    model_config = ConfigDict(frozen=True, extra="forbid", hide_input_in_errors=True)
