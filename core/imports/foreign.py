"""What the files of other programs have in common once they are read: checked tables, and keys that are not used."""

from typing import Any, TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError

from railjoule.core.errors import ScenarioError
from railjoule.core.imports.source_file import shown_list
from railjoule.core.scenario._sentences import sentence_of


class Foreign(BaseModel):
    """A table of a file that others define: keys that are not known are kept, to be told as not used."""

    # hide_input: `sentence_of` shows it itself, and shortened
    model_config = ConfigDict(frozen=True, extra="allow", hide_input_in_errors=True)


Table = TypeVar("Table", bound=Foreign)


def checked(model: type[Table], document: Any, source: str) -> Table:
    """Return a table of a file.

    Raises
    ------
    ScenarioError
        If it has not the keys and values that it should; the sentence begins with `source`.
    """
    try:
        return model.model_validate(document)
    except ValidationError as error:
        raise ScenarioError(sentence_of(error, model, source)) from None


def unknown_keys(table: Foreign, source: str) -> list[str]:
    """Return in words the keys of a table that are not known here."""
    names = list(table.model_extra or {})
    return [f"{source}: {shown_list(names, 20)}."] if names else []
