"""Tables of pieces of HTML as rows."""

from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.parts.tables import named_tables


def test_cells_are_read_as_programs_need_them() -> None:
    name = parts.swatch("optimal") + "5 < 6 & more"
    rows = [((name, "\u22121\u202f500.5", "+3", "\u2013"), True), (("=1+1", "a,b", "", "42 s"), False)]
    made = parts.table("Runs <here>", ("Run", "from, m", "%", "s"), rows)
    assert named_tables(f"<p>1</p>{made}<table><tr><td>2</table>") == [
        (
            "Runs <here>",
            [
                ["Run", "from, m", "%", "s"],
                ["5 < 6 & more", "-1500.5", "3", "\u2013"],
                ["=1+1", "a,b", "", "42 s"],
            ],
        )
    ]
