"""Rolling stock and running paths of railtoolkit's schema: YAML 2022.05 and 2024.07."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Annotated, Any

from pydantic import Field, model_validator

from railjoule.core.errors import ScenarioError
from railjoule.core.imports.findings import Foreign, Notes
from railjoule.core.imports.line import ImportedLine, build_line
from railjoule.core.imports.railtoolkit_train import read_train
from railjoule.core.imports.source_file import SourceFile, read_unicode
from railjoule.core.imports.table import ImportedTable, bounded, require_rising, stepwise
from railjoule.core.imports.units import IntervalKind
from railjoule.core.imports.vehicle import ImportedVehicle
from railjoule.core.scenario._base import Number
from railjoule.core.scenario._sentences import show, shown_list, validated

VERSIONS = ("2022.05", "2024.07")
"""The first and the last that are known."""
# the reader is written in Python: 100 kB take it a second
MAX_YAML_BYTES = 2_000_000
MAX_LEVELS = 20
"""Lists and tables within each other; the files have 6."""


class CharacteristicSection(Foreign):
    """The begin of a limit or a resistance, as version 2024.07 has it; 2022.05 has lists of three."""

    position: Number
    speed: Annotated[Number, Field(gt=0)] | None = None
    resistance: Number | None = None

    @model_validator(mode="before")
    @classmethod
    def _from_list(cls, row: Any) -> Any:
        is_old = isinstance(row, list) and len(row) == 3
        return dict(zip(("position", "speed", "resistance"), row, strict=True)) if is_old else row


class Path(Foreign):
    """A line."""

    id: str = Field(max_length=200)
    name: str = ""
    characteristic_sections: tuple[CharacteristicSection, ...] = Field(min_length=2, max_length=100_000)


class RunningPath(Foreign):
    """A file of lines."""

    paths: tuple[Path, ...] = Field(min_length=1, max_length=1000)


def read_railtoolkit(source: SourceFile, wanted: str | None = None) -> ImportedVehicle | ImportedLine:
    """Return the train or the path of a file.

    Parameters
    ----------
    source : SourceFile
        YAML of the schema rolling-stock or running-path, 2022.05 or 2024.07.
    wanted : str, optional
        The id of the train or path; by default the only one.

    Raises
    ------
    ChoiceError
        If there are several and none is named.
    ScenarioError
        If anything is wrong with the file; the sentence names field, value and bound.
    """
    document = read_yaml(source)
    schema = str(document.pop("schema", ""))
    notes = Notes(source.name)
    notes.version("schema_version", str(document.pop("schema_version", "")), VERSIONS)
    if "running-path" in schema or ("paths" in document and "rolling-stock" not in schema):
        return _read_path(document, wanted, notes)
    if "rolling-stock" in schema or "vehicles" in document:
        return read_train(document, wanted, notes)
    raise ScenarioError(f"{source.name}: schema = {show(schema)} must be that of rolling-stock or running-path.")


def read_yaml(source: SourceFile) -> dict[str, Any]:
    """Return the table that a YAML file holds.

    Raises
    ------
    ScenarioError
        If PyYAML is missing, the file is too large or no YAML, or it has aliases, which can stand for very much.
    """
    try:
        import yaml  # noqa: PLC0415  (of an extra)
    except ModuleNotFoundError:
        raise ScenarioError(
            f"{source.name}: reading YAML needs PyYAML, which is not installed: pip install 'railjoule[yaml]'."
        ) from None
    if len(source.content) > MAX_YAML_BYTES:
        raise ScenarioError(f"{source.name}: larger than the {MAX_YAML_BYTES / 1e6:g} MB permitted.")
    text = read_unicode(source, "YAML")
    try:
        level = 0
        for event in yaml.parse(text, yaml.SafeLoader):
            level += isinstance(event, yaml.CollectionStartEvent) - isinstance(event, yaml.CollectionEndEvent)
            if isinstance(event, yaml.AliasEvent):
                alias = f"the alias *{event.anchor} is not read; write out what it stands for"
                raise ScenarioError(f"{source.name}: {alias}.")
            if level > MAX_LEVELS:
                raise ScenarioError(f"{source.name}: its lists or tables are nested too deeply.")
        document = yaml.safe_load(text)
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        where = f" in line {mark.line + 1}" if mark is not None else ""
        raise ScenarioError(f"{source.name}: not YAML: {getattr(error, 'problem', None) or error}{where}.") from None
    # of dates such as 2022-13-45 and of integers with more than 4300 digits
    except ValueError as error:
        raise ScenarioError(f"{source.name}: not YAML: {show(str(error))}.") from None
    if not isinstance(document, dict):
        raise ScenarioError(f"{source.name}: must be a YAML table.")
    return {str(key): value for key, value in document.items()}


def _read_path(document: Mapping[str, Any], wanted: str | None, notes: Notes) -> ImportedLine:
    source = notes.source
    file = validated(RunningPath, document, source)
    notes.add_unknown_keys(file)
    path = file.paths[notes.chosen([path.id for path in file.paths], wanted, "path")]
    notes.add_unknown_keys(path, f"path {path.id}: ")
    rows = path.characteristic_sections
    require_rising([row.position for row in rows], f"{source}: characteristic_sections")
    if keys := sorted({key for row in rows for key in (row.model_extra or {})}):
        notes.add_unused(f"characteristic_sections: {shown_list(keys)}.")
    notes.add("assumption", "resistance is taken as the gradient: it may hold that of curves too.")
    line = build_line(
        gradients=_table("gradients", source, [(row.position, row.resistance) for row in rows]),
        limits=_table("limits", source, [(row.position, row.speed) for row in rows]),
        begin_m=rows[0].position,
        end_m=rows[-1].position,
        name=path.name or path.id,
    )
    return replace(line, findings=(*notes.findings, *line.findings), unused=(*notes.unused, *line.unused))


def _table(kind: IntervalKind, source: str, rows: list[tuple[float, float | None]]) -> ImportedTable | None:
    """Make a table of values that hold until the next is given; the last section is only the end of the path."""
    where = f"{source}: characteristic_sections"
    given = [(begin, bounded(where, kind, value, value, kind)) for begin, value in rows[:-1] if value is not None]
    begins, values = [begin for begin, _ in given], [value for _, value in given]
    return stepwise(kind, source, begins, values, rows[-1][0]) if given else None
