"""Printed numbers, claims and figures of a paper with those of railjoule: the types of every comparison."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Literal

from railjoule.core.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class Line:
    """One curve of a panel.

    Parameters
    ----------
    label : str
        Its entry in the legend.
    x, y : array of shape (n,)
        In the units of the panel's axes.
    is_printed : bool
        Whether the paper prints these numbers; they are drawn as points.
    """

    label: str
    x: FloatArray
    y: FloatArray
    is_printed: bool = False


@dataclass(frozen=True, eq=False)
class Panel:
    """One pair of axes.

    Parameters
    ----------
    x_title, y_title : str
        Quantity and unit of each axis, such as 'Speed, km/h'.
    lines : tuple of Line
    """

    x_title: str
    y_title: str
    lines: tuple[Line, ...]


@dataclass(frozen=True, eq=False)
class FigureData:
    """The content of a rebuilt figure.

    Parameters
    ----------
    panels : tuple of Panel
    note : str
        One or two sentences on agreement with the print.
    """

    panels: tuple[Panel, ...]
    note: str = ""


@dataclass(frozen=True)
class PaperFigure:
    """A printed figure that can be rebuilt.

    Parameters
    ----------
    place : str
        Its name in the paper, such as 'Fig. 4'; figures that are drawn together share one entry.
    caption : str
        Its content.
    compute : callable
        Returns its `FigureData`; takes seconds.
    scenario : str
        Name of the scenario that the workbench opens.
    changes : mapping
        Fields of the scenario that differ there, by dotted path as in `Scenario.with_`.
    """

    place: str
    caption: str
    compute: Callable[[], FigureData]
    scenario: str
    changes: Mapping[str, Any] = field(default_factory=dict)


# Printed numbers have three digits, and papers round their inputs as well, so smaller differences have no meaning.
CLOSE_PERCENT = 1.0
"""Close numbers differ by at most this: in percent, percentages in percentage points."""

Verdict = Literal["supports", "refutes", "cannot be decided"]
"""The judgement of a claim."""


@dataclass(frozen=True)
class Claim:
    """A sentence of a paper that asserts a number or a comparison, with the finding of railjoule.

    Parameters
    ----------
    place : str
        Section, table, figure or formula of the paper.
    claim : str
        The assertion.
    found : str
        The number or numbers of railjoule, with units.
    verdict : {'supports', 'refutes', 'cannot be decided'}
    reason : str
        One or two sentences: by which measure, or what the paper leaves open.
    """

    place: str
    claim: str
    found: str
    verdict: Verdict
    reason: str


@dataclass(frozen=True)
class Row:
    """One printed number and that of railjoule.

    Parameters
    ----------
    case : str
        The run, such as 'T_m = 270 s'.
    quantity : str
    unit : str
        Unit of both numbers; empty where they have none.
    printed : float or None
        The reference; None where there is none.
    value : float
        The number that this version computes.
    note : str
        One sentence on a difference that stays; empty where none needs explaining.
    source : str
        Table or figure, case and quantity of the printed number, so that each counts once however often it is
        compared; empty where the reference is no printed number.
    """

    case: str
    quantity: str
    unit: str
    printed: float | None
    value: float
    note: str = ""
    source: str = ""

    @property
    def difference_percent(self) -> float | None:
        """Computed over printed number less 1, in percent; None where nothing or zero is printed."""
        # a share of zero is undefined: such rows show both numbers and no difference
        if self.printed is None or self.printed == 0:
            return None
        return 100 * (self.value / self.printed - 1)

    @property
    def is_percentage(self) -> bool:
        """Whether both numbers are percentages: a small one may be many times another that is next to it."""
        return self.unit == "%"

    @property
    def difference_points(self) -> float | None:
        """Computed less printed percentage, in percentage points; None for other units or where none is printed."""
        return self.value - self.printed if self.is_percentage and self.printed is not None else None

    @property
    def difference(self) -> float | None:
        """The difference that is fair to the quantity: of percentages in percentage points, of others in percent."""
        return self.difference_points if self.is_percentage else self.difference_percent

    @property
    def is_close(self) -> bool:
        """Whether that difference is known and at most `CLOSE_PERCENT`."""
        return self.difference is not None and abs(self.difference) <= CLOSE_PERCENT


@dataclass(frozen=True)
class Table:
    """Rows that belong together.

    Parameters
    ----------
    title : str
        Content of the rows.
    rows : tuple of Row
    place : str
        Place in the paper; empty if it is not printed.
    reference : str
        Name of the column of printed numbers.
    """

    title: str
    rows: tuple[Row, ...]
    place: str = ""
    reference: str = "printed"


def first_comparisons(tables: Iterable[Table]) -> tuple[Row, ...]:
    """Return one row for each printed number of a paper: the first that compares it.

    Each paper's tables begin with those that compute as the paper does. Rows whose reference is not printed, or that
    have no difference because zero is printed, are omitted.

    Parameters
    ----------
    tables : iterable of Table
        All tables of one paper, in their order.
    """
    rows = (row for table in tables for row in table.rows if row.source and row.difference is not None)
    first: dict[str, Row] = {}
    for row in rows:
        first.setdefault(row.source, row)
    return tuple(first.values())


@dataclass(frozen=True)
class Erratum:
    """A misprint of a paper and its correction, with place and reason."""

    place: str
    printed: str
    corrected: str
    reason: str


@dataclass(frozen=True)
class Validation:
    """A paper's printed numbers and claims with those of railjoule.

    Parameters
    ----------
    paper : str
        Short name, as on the command line.
    citation : str
        Authors, title, journal and year.
    tables : tuple of Table
    errata : tuple of Erratum
    claims : tuple of Claim
    """

    paper: str
    citation: str
    tables: tuple[Table, ...]
    errata: tuple[Erratum, ...]
    claims: tuple[Claim, ...] = ()


@dataclass(frozen=True)
class Comparison:
    """The tables and claims of a paper, not computed yet.

    Parameters
    ----------
    paper, citation, errata
        As in `Validation`.
    tables : tuple of callable
        The computation of each table.
    claims : tuple of callable
        The examination of each claim.
    figures : tuple of PaperFigure
        The printed figures that can be rebuilt.
    """

    paper: str
    citation: str
    tables: tuple[Callable[[], Table], ...]
    errata: tuple[Erratum, ...]
    claims: tuple[Callable[[], Claim], ...] = ()
    figures: tuple[PaperFigure, ...] = ()

    @property
    def step_count(self) -> int:
        """Number of tables and claims."""
        return len(self.tables) + len(self.claims)

    def steps(self) -> Iterator[Validation]:
        """Yield the comparison with one more table or claim each time, at first with none."""
        done = Validation(self.paper, self.citation, (), self.errata)
        yield done
        for compute in self.tables:
            done = replace(done, tables=(*done.tables, compute()))
            yield done
        for examine in self.claims:
            done = replace(done, claims=(*done.claims, examine()))
            yield done

    def validation(self) -> Validation:
        """Return the comparison with all its tables and claims."""
        *_, last = self.steps()
        return last
