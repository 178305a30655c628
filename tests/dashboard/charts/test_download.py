"""The file with the numbers of a page."""

import zipfile

from railjoule.dashboard.charts.download import archive
from railjoule.dashboard.parts import html as parts


def test_each_figure_table_and_drawing_has_a_file_of_its_own() -> None:
    figures = [("Speed, km/h", [("optimal", {"x": [0], "y": [1]})], {"y": "Speed, km/h"}), ("Empty", [], {})]
    drawing = '<svg xmlns="" data-figure="Energy, kWh"><path d="M0 0"/></svg>'
    tables = [str(parts.table("Runs", ("Run",), [(("=1+1",), False)])), str(parts.table("Runs", (), ()))]
    texts = [tables[0], f"<div>{drawing}</div>", tables[1]]
    with zipfile.ZipFile(archive(figures, texts)) as packed:
        found = {name: packed.read(name).decode() for name in packed.namelist()}
    assert found == {
        "speed-km-h.csv": 'series,x,"Speed, km/h"\noptimal,0,1\n',
        "runs.csv": "Run\n'=1+1\n",
        "energy-kwh.svg": drawing,
        "runs-2.csv": "\n",
    }
