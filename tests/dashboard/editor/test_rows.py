import pytest

from railjoule.dashboard.editor.fields_of import Table, parts_of
from railjoule.dashboard.editor.rows import CellError, rows_of

(SECTIONS,) = [part for part in parts_of("line") if part.key == "line.sections"]
assert isinstance(SECTIONS, Table)
COLUMNS = SECTIONS.columns
TWO = [{"length_m": 1200.5, "gradient_permille": -3.0}, {"length_m": 800.0}]


@pytest.mark.parametrize(
    "text",
    [
        "1200.5\t-3\n800\t\n",
        "1200,5\t\u22123\r\n800\t\r\n",
        "1\u202f200,5;-3\n\n800;",
        "1 200.5\t-3\n800",
        "1200.5,-3\n800,\n",
        "length_m,gradient_permille\n1200.5,-3\n800,",
        "Length, m\tGradient, \u2030\n1200,5\t-3\n800",
        "gradient_permille;length_m\n-3;1200,5\n;800",
        '"1200,5","-3"\n800,',
    ],
)
def test_blocks_as_spreadsheets_give_them(text: str) -> None:
    assert rows_of(text, COLUMNS) == TWO


def test_a_block_may_begin_in_another_column() -> None:
    assert rows_of("5\t60", COLUMNS, first=1) == [{"gradient_permille": 5.0, "speed_limit_kmh": 60.0}]


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("", "The table is empty."),
        ("100\t2\n100\tsteep", "Row 2, Gradient, \u2030: 'steep'. Not a number."),
        ("0\t2", "Row 1, Length, m: '0'. Above 0."),
        ("100\t2\t700", "Row 1, Speed limit, km/h: '700'. At most 600."),
        ("1\t2\t3\t4\t5\t6", "Row 1: 6 cells for 5 columns."),
        ("length_m,slope\n1,2", "Row 1: unknown column 'slope', choose one of"),
        ("length_m,gradient_permile\n1,2", "Row 1: unknown column 'gradient_permile', did you mean gradient_permille?"),
        ("length_m,length_m\n1,2", "Row 1: a column appears twice."),
        ("length_m;gradient_permille\n1;201", "Row 2, Gradient, \u2030: '201'. At most 200."),
    ],
)
def test_a_bad_block_is_refused_with_row_column_value_and_bound(text: str, sentence: str) -> None:
    with pytest.raises(CellError) as told:
        rows_of(text, COLUMNS)
    assert str(told.value).startswith(sentence)


@pytest.mark.parametrize("text", ["\x00", "a\tb\tc\td\te\tf", "1e999", "-", "1,2\n\t\t\t\t\t\t9"])
def test_nothing_but_its_own_refusal_comes_out(text: str) -> None:
    with pytest.raises(CellError):
        rows_of(text, COLUMNS)
