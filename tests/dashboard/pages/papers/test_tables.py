import csv
import re
from io import StringIO

import pytest

from railjoule.core.validation import Claim, Erratum, Row, Table, Validation
from railjoule.dashboard.pages.papers.tables import (
    errata_html,
    finding,
    overview_html,
    reasons_html,
    summary_words,
    table_html,
    tables_csv,
    typeset,
    typeset_plain,
)

TABLE = Table(
    "Energies & <times>",
    (
        Row("a", "W", "Wh", 100.0, 100.01),
        Row("b", "W", "Wh", 100.0, 103.0, "A <b>reason</b>."),
        Row("c", "W", "Wh", None, 7.0),
    ),
    "Table 1",
)


def test_a_table_says_how_close_it_is_and_escapes_its_texts() -> None:
    text = table_html(TABLE)
    assert "1 of 2 within 1 %" in text
    assert '<span class="open">+3.0 %</span>' in text
    assert "Energies &amp; &lt;times&gt;" in text
    assert "A &lt;b&gt;reason&lt;/b&gt;." in text


def test_corrections_are_listed_and_escaped() -> None:
    text = errata_html((Erratum("Eq. 3", "<", ">", "By its units."),))
    assert "Corrections <span>1</span>" in text
    assert "<li>Eq. 3: printed &lt;, corrected: &gt;. By its units.</li>" in text
    assert errata_html(()) == ""


PERCENTAGES = (Row("d", "more", "%", 0.1, 2.2), Row("e", "more", "%", 0.0, 0.4))


def test_percentages_are_told_by_points() -> None:
    text = table_html(Table("Overconsumption", PERCENTAGES))
    assert '<span class="open">+2.1 pp</span>' in text
    assert "+0.40 pp" in text
    assert "1 of 2 within 1 percentage point<" in text


def test_a_table_of_both_names_both_measures() -> None:
    text = summary_words(Table("Both", (*TABLE.rows, *PERCENTAGES)))
    assert text == "2 of 4 within 1 %, percentages within 1 percentage point"


def test_the_csv_holds_every_row() -> None:
    rows = list(csv.DictReader(StringIO(tables_csv((TABLE, TABLE)))))
    assert len(rows) == 6
    assert rows[1]["difference_percent"].startswith("3.0")
    assert rows[2]["printed"] == ""


def test_the_head_counts_only_printed_numbers_and_each_once() -> None:
    close, differs = Row("a", "W", "Wh", 2.0, 2.0, source="a"), Row("b", "W", "Wh", 2.0, 3.0, "Because.", "b")
    again = Row("a", "W by parts", "Wh", 2.0, 3.0, "Because.", "a")
    tables = (Table("One", (close, differs)), Table("Two", (again, Row("c", "W", "Wh", 2.0, 2.0))))
    claims = (Claim("p", "c", "f", "refutes", "r"), Claim("p", "d", "f", "supports", "r"))
    paper = Validation("ftorek", "", tables, (), claims)
    text = finding([paper])
    assert "supports 1 of 2 claims of the papers, refutes 1 and leaves 0 undecided" in text
    assert "Of 2 printed numbers 1 agree within 1 %, 1 differ for a stated reason and none without one" in text
    row = re.search(r"Ftorek(.*?)<tr", overview_html({"ftorek": paper}))
    assert re.findall(r"<td>(\d+)", row[1]) == ["2", "1", "1", "0", "2", "1", "1", "0"]


@pytest.mark.parametrize(
    ("text", "html"),
    [
        ("T_m = 270 s", "T<sub>m</sub> = 270 s"),
        ("g = 9.81 m/s2, -8.10 % and 10-20", "g = 9.81 m/s\u00b2, \u22128.10 % and 10-20"),
        ("<b>", "&lt;b&gt;"),
    ],
)
def test_signs_of_papers_are_typeset(text: str, html: str) -> None:
    assert typeset(text) == html


def test_symbols_of_figures_have_subscripts_where_there_are_such_letters() -> None:
    assert typeset_plain("T_m = 300 s, L_pb, W_sh, m/s2") == "T\u2098 = 300 s, L_pb, W\u209b\u2095, m/s\u00b2"


def test_reasons_that_differ_in_a_number_are_one_and_close_numbers_have_none() -> None:
    notes = (
        "The plan for a train 12 % lighter",
        "The plan for a train 24 % heavier",
        "The plan for a train 24 % heavier",
    )
    rows = (Row(f"{k}", "W", "Wh", 100.0, 110.0, note, f"{k}") for k, note in enumerate((*notes, "Another.")))
    table = Table("Energies", (*rows, Row("x", "W", "Wh", 100.0, 100.1, "Close.", "x")), "Table 1")
    text = reasons_html({"ftorek": Validation("ftorek", "", (table,), ())})
    assert "<td>Ftorek<td>3<td>The plan for a train 24 % heavier" in text
    assert "<td>1<td>Another." in text
    assert "lighter" not in text
    assert "Close." not in text
