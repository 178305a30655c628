"""The file with the numbers of a page."""

import asyncio
import zipfile

import pytest

from railjoule.dashboard.app import Session
from railjoule.dashboard.charts.download import archive
from railjoule.dashboard.parts import html as parts

# Panel warns once of how panel-material-ui calls it
pytestmark = pytest.mark.filterwarnings("ignore::PendingDeprecationWarning")


def test_each_figure_table_and_drawing_has_a_file_of_its_own() -> None:
    figures = [("Speed, km/h", [("optimal", {"x": [0], "y": [1]})], {"y": "Speed, km/h"}), ("Empty", [], {})]
    drawing = '<svg xmlns="" data-figure="Energy, kWh"><path d="M0 0"/></svg>'
    tables = [str(parts.table("Runs", ("Run",), [(("=1+1",), False)])), str(parts.table("Runs", (), ()))]
    texts = [tables[0], f"<div>{drawing}</div>", tables[1]]
    with zipfile.ZipFile(archive(figures, texts, "railjoule 1.0")) as packed:
        found = {name: packed.read(name).decode() for name in packed.namelist()}
    assert found == {
        "about.txt": "railjoule 1.0",
        "speed-km-h.csv": 'series,x,"Speed, km/h"\noptimal,0,1\n',
        "runs.csv": "Run\n'=1+1\n",
        "energy-kwh.svg": drawing,
        "runs-2.csv": "\n",
    }


def open_view(session, page):
    session.state.page = page
    return session.views[page]


def test_hidden_numbers_of_a_former_scenario_are_not_saved() -> None:
    session = Session()
    session.state.scenario.choose("ftorek-300s")
    motor = open_view(session, "Motor")
    assert "eoc-and-enoc-energy-at-the-motors-so-far-kwh.csv" in saved_names(motor)
    # neither strategy takes the tram
    session.state.scenario.choose("tram-950m")
    assert "eoc-and-enoc-energy-at-the-motors-so-far-kwh.csv" not in saved_names(motor)


def saved_names(view):
    with zipfile.ZipFile(asyncio.run(view.numbers._file())) as packed:
        return set(packed.namelist())
