"""The block diagram as it is drawn: all blocks can be reached, named and lit, and every figure has one."""

import xml.etree.ElementTree as ET

import pytest

from railjoule.dashboard.pages.motor.loop_diagram import BLOCKS, DRAWINGS, Drawing, diagram
from railjoule.dashboard.pages.motor.page import Motor


@pytest.mark.parametrize("drawing", DRAWINGS, ids=lambda drawing: drawing.kind)
def test_each_block_can_be_reached_and_has_a_name(drawing: Drawing) -> None:
    blocks = [shape for shape in ET.fromstring(diagram(drawing)).iter("g") if shape.get("data-block")]
    assert [shape.get("data-block") for shape in blocks] == list(BLOCKS)
    assert {shape.get("tabindex") for shape in blocks} == {"0"}
    assert blocks[1].get("aria-label", "").startswith("Pre-compensator leads the reference")
    names = [shape.get("aria-label") for shape in blocks]
    assert len(set(names)) == len(BLOCKS)


@pytest.mark.parametrize("drawing", DRAWINGS, ids=lambda drawing: drawing.kind)
def test_blocks_lie_apart_and_inside(drawing: Drawing) -> None:
    width, height = drawing.size
    boxes = [(x, y, x + drawing.block_width, y + 44) for x, y in drawing.places.values()]
    assert all(left > 0 and right < width and top > 0 and bottom < height for left, top, right, bottom in boxes)
    for k, one in enumerate(boxes):
        for other in boxes[k + 1 :]:
            assert one[2] <= other[0] or other[2] <= one[0] or one[3] <= other[1] or other[3] <= one[1]


def test_every_figure_of_the_page_has_one_block() -> None:
    explained = [name for block in BLOCKS.values() for name in block.charts]
    assert sorted(explained) == sorted(plot.name for plot in Motor.figures)
