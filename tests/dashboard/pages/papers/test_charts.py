"""Differences from printed numbers: the rows of the figure, and what it looks like."""

import math

import pytest

from railjoule.core.validation import Row, Table, Validation
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.look.tokens import THEMES
from railjoule.dashboard.pages.papers.charts import STYLES, TIP_COLUMNS, DifferencesChart, differences, scaled
from railjoule.dashboard.pages.papers.compute import AUTHORS, shipped_tables

ROWS = (
    Row("a", "W", "Wh", 100.0, 103.0, source="a"),
    Row("b", "W", "Wh", None, 7.0),
    Row("c", "more", "%", 2.0, 1.5, source="c"),
    Row("d", "W", "Wh", 0.0, 7.0, source="d"),
    # by another solver and not printed
    Row("e", "W", "Wh", 100.0, 104.0),
)


def paper(name: str) -> Validation:
    return Validation(name, "", (Table("Energies", ROWS),), ())


def test_a_row_with_a_difference_is_a_dot() -> None:
    found = differences([paper("ftorek"), paper("rawicki")])
    assert [of["x"] for of in found.values()] == [[1, 2], [3, 4]]
    # 3 % of 100 Wh, and half a percentage point less
    assert found["ftorek"]["y"] == pytest.approx([math.asinh(3.0), math.asinh(-0.5)])
    assert [found["rawicki"][word][0] for word in TIP_COLUMNS] == [
        "Rawicki",
        "Energies",
        "a",
        "W",
        "100 Wh",
        "103.0 Wh",
        "+3.0 %",
    ]


def drawn(papers: list[Validation], dark: bool = False) -> DifferencesChart:
    chart = DifferencesChart("differences", "Differences, %", 300, Palette(dark))
    chart.show(lambda: chart.draw(papers))
    return chart


@pytest.mark.parametrize("dark", [False, True])
def test_the_shipped_numbers_are_drawn_by_paper(dark: bool) -> None:
    papers = list(shipped_tables().papers.values())
    compared = {
        one.paper: sum(bool(row.source) and row.difference is not None for table in one.tables for row in table.rows)
        for one in papers
    }
    names = [name for name, count in compared.items() if count]
    f = drawn(papers, dark).figure
    assert [item.label.value for item in f.legend[0].items] == [AUTHORS[name] for name in names]
    tokens = THEMES["dark" if dark else "light"]
    for layer, name in zip(f.renderers, names, strict=True):
        assert len(layer.data_source.data["x"]) == compared[name]
        assert (layer.glyph.fill_color, layer.glyph.marker) == (tokens[STYLES[name][0]], STYLES[name][1])
    assert f.yaxis[0].major_label_overrides[scaled(-30)] == "\u221230"
    (tip,) = f.hover
    assert all(f"@{word}" in tip.tooltips for word in TIP_COLUMNS)


def test_every_paper_has_a_colour_and_a_name() -> None:
    assert STYLES.keys() == AUTHORS.keys() == shipped_tables().papers.keys()


def test_without_any_difference_there_is_an_empty_figure() -> None:
    assert drawn([]).figure.renderers == []
