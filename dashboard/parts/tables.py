"""The tables of pieces of HTML as rows of cells."""

from html.parser import HTMLParser


class _Reader(HTMLParser):
    """Collects the cells of all tables that have a name."""

    def __init__(self) -> None:
        super().__init__()
        self.tables: list[tuple[str, list[list[str]]]] = []
        self._is_inside = False

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        name = dict(attrs).get("data-name") if tag == "table" else None
        if tag == "table":
            self._is_inside = name is not None
        if name is not None:
            self.tables.append((name, []))
        elif self._is_inside and tag == "tr":
            self.tables[-1][1].append([])
        elif self._is_inside and tag in {"td", "th"}:
            self.tables[-1][1][-1].append("")

    def handle_endtag(self, tag: str) -> None:
        if tag == "table":
            self._is_inside = False

    def handle_data(self, data: str) -> None:
        if self._is_inside and self.tables[-1][1] and self.tables[-1][1][-1]:
            self.tables[-1][1][-1][-1] += data


def named_tables(html: str) -> list[tuple[str, list[list[str]]]]:
    """Return name and rows of each named table of a piece of HTML, the headings first."""
    reader = _Reader()
    reader.feed(html)
    reader.close()
    return [(name, [list(map(_plain, row)) for row in rows]) for name, rows in reader.tables]


def _plain(cell: str) -> str:
    """Return a cell without the signs that only people read as part of a number."""
    number = cell.strip().replace("\u202f", "").replace("\u2212", "-").removeprefix("+")
    try:
        float(number)
    except ValueError:
        return cell.strip()
    return number
