"""The numbers of charts as tables."""

import numpy as np
from bokeh.plotting import figure

from railjoule.core.csv_text import csv_of_table
from railjoule.dashboard.charts.axis import Axis
from railjoule.dashboard.charts.download import series, table
from railjoule.dashboard.charts.figures import DistanceChart, LoneChart
from railjoule.dashboard.charts.surface import Scene
from railjoule.dashboard.look.paint import Palette


def text(chart: LoneChart | DistanceChart) -> str:
    """Return the numbers of a chart as CSV."""
    return csv_of_table(table(*series(chart)))


def test_lines_share_columns_and_texts_are_left_out() -> None:
    palette = Palette(dark=False)
    axis = Axis(palette)
    chart = DistanceChart("speed", "Speed, km/h", 200, axis, palette)
    f = chart.frame()
    runs = chart.source("runs", "position", "speed", "other")
    runs.data = {"position": np.float32([0, 0.1]), "speed": np.float32([1 / 3, 2]), "other": np.float32([7, 8])}
    f.line("position", "speed", source=runs, name="optimal")
    f.line("position", "other", source=runs, name="hidden", visible=False)
    chart.signs("names", "ink")
    chart.put("names", x=[1], y=[2], text=["optimal"])
    chart.hairlines("borders", "line2")
    chart.put("borders", x=[3])
    axis.settle("m", 0)
    assert text(chart) == 'series,"Distance, m","Speed, km/h"\noptimal,0.0,0.33333334\noptimal,0.1,2.0\n'


def test_bars_and_points_have_units_in_their_headings() -> None:
    chart = LoneChart("bars", "Runs, %", 200, Palette(dark=False))
    chart.frame(x_title="Energy, kWh")
    chart.glyphs("quad", "bars", "left", "right", 0, "top", paint={"fill_color": "accent"}, line_color="colour")
    chart.put("bars", left=[1.0], right=[2.0], top=[50.0], colour=["#FFFFFF"])
    chart.dots("worst")
    chart.put("worst", x=[3.0], y=[1.0])
    assert text(chart).splitlines() == [
        'series,"left: Energy, kWh","right: Energy, kWh","top: Runs, %","Energy, kWh","Runs, %"',
        "bars,1.0,2.0,50.0,,",
        "worst,,,,3.0,1.0",
    ]


def test_a_picture_has_its_cells() -> None:
    chart = LoneChart("law", "Speed, km/h", 200, Palette(dark=False))
    f = chart.frame(x_title="Distance, m")
    assert isinstance(f, figure)
    source = chart.source("law", "image", "x", "y", "dw", "dh")
    source.data = {"image": [np.array([[1.0, 2.0]])], "x": [0], "y": [0], "dw": [10], "dh": [4]}
    f.image("image", x="x", y="y", dw="dw", dh="dh", source=source, palette="Cividis256")
    assert text(chart).splitlines()[1:] == ["law,2.5,2.0,1.0", "law,7.5,2.0,2.0"]


def test_a_surface_has_its_nodes() -> None:
    chart = LoneChart("surface", "Energy, kWh", 200, Palette(dark=False))
    axes = {f"{axis}axis": {"title": {"text": words}} for axis, words in (("x", "Load, %"), ("y", "Time, s"))}
    trace = {"type": "surface", "x": [0, 1], "y": [5], "z": [[2, np.nan]]}
    scene = Scene(200, "Energy, kWh")
    scene.draw([trace], {"scene": axes})
    chart.figure = scene
    header, *rows = text(chart).splitlines()
    assert header == 'series,"Load, %","Time, s","Energy, kWh"'
    assert rows == ["surface,0.0,5.0,2.0", "surface,1.0,5.0,"]
