import re
from pathlib import Path

from railjoule.dashboard.look.theme import padded, parts_css, strategies_css
from railjoule.dashboard.look.tokens import DASHES, NARROW_PX, PIN_DASHES, WIDE_PX, variable

ROOT = Path(__file__).parents[3]


def test_all_style_sheets_have_the_same_borders() -> None:
    paths = [*(ROOT / "dashboard").rglob("*.py"), *(ROOT / "assets" / "css").glob("*.css")]
    texts = [*(path.read_text(encoding="utf-8") for path in paths), padded("1px", "2px")]
    ends = {int(end) for text in texts for end in re.findall(r"max-width: (\d+)px\)", text)}
    assert {end for end in ends if abs(end - NARROW_PX) < 50 or abs(end - WIDE_PX) < 50} == {
        NARROW_PX - 1,
        WIDE_PX - 1,
    }


def test_each_line_has_a_sample() -> None:
    for sheet in (parts_css(), strategies_css()):
        assert all(f".stroke.{variable(name)} {{ stroke: var(--rj-" in sheet for name in (*DASHES, *PIN_DASHES))
