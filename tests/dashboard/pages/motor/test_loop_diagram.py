"""The block diagram as it is drawn: all blocks can be reached, named and lit, and every figure has one."""

import xml.etree.ElementTree as ET

import pytest

from railjoule.dashboard.pages.motor.charts import CHARTS, drawing
from railjoule.dashboard.pages.motor.page import Motor

WIDE, NARROW = ET.fromstring(f"<div>{drawing()}</div>")


@pytest.mark.parametrize("picture", [WIDE, NARROW], ids=["wide", "narrow"])
def test_each_block_can_be_reached_and_has_a_name(picture: ET.Element) -> None:
    blocks = [shape for shape in picture.iter("g") if shape.get("data-block")]
    assert [shape.get("data-block") for shape in blocks] == list(CHARTS)
    assert {shape.get("tabindex") for shape in blocks} == {"0"}
    assert blocks[1].get("aria-label", "").startswith("Pre-compensator leads the reference")
    assert len({shape.get("aria-label") for shape in blocks}) == len(CHARTS)


@pytest.mark.parametrize("picture", [WIDE, NARROW], ids=["wide", "narrow"])
def test_blocks_lie_apart_and_inside(picture: ET.Element) -> None:
    _, _, width, height = (float(number) for number in picture.get("viewBox", "").split())
    sides = [[float(rect.get(name, "")) for name in ("x", "y", "width", "height")] for rect in picture.iter("rect")]
    boxes = [(x, y, x + wide, y + high) for x, y, wide, high in sides]
    assert len(boxes) == len(CHARTS)
    assert all(left > 0 and right < width and top > 0 and bottom < height for left, top, right, bottom in boxes)
    for k, one in enumerate(boxes):
        for other in boxes[k + 1 :]:
            assert one[2] <= other[0] or other[2] <= one[0] or one[3] <= other[1] or other[3] <= one[1]


def test_every_figure_of_the_page_has_a_block_and_every_block_a_figure() -> None:
    assert {name for names in CHARTS.values() for name in names} == {plot.name for plot in Motor.figures}
    assert all(CHARTS.values())
