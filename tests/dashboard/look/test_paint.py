from bokeh.models import Span

from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.look.tokens import DARK, LIGHT


def test_painted_models_follow_the_theme() -> None:
    palette, line = Palette(dark=False), Span()
    palette.paint(line, line_color="accent")
    assert line.line_color == LIGHT["accent"]
    palette.switch(dark=True)
    assert line.line_color == DARK["accent"]
    assert palette.tokens == DARK
