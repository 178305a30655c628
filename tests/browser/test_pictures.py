"""README's picture looks like the page that it shows, with any font rasteriser.

Both are compared as grey values (0 to 255) of 64 by 43 blocks of 20 px. On 26 November 2026 two drawings of the page
differed by more than 8 in no block, the page blurred by 3 px in none, shifted down by a pixel in 16, and the picture
without the strategy `linear_reserve` in 50. `python -m tests.browser.pictures` takes the pictures again.
"""

import io

import matplotlib.image
import numpy as np
import pytest
from playwright.sync_api import BrowserContext

from browser.pictures import SIZE, picture_path, take_picture
from browser.server import Server
from railjoule.core.arrays import FloatArray

BLOCK_PX = 20
MAX_GREY, MAX_BLOCKS = 8.0, 20
LUMA = (0.299, 0.587, 0.114)
"""Weights of red, green and blue in a grey value, ITU-R BT.601."""


def grey_values(png: bytes) -> FloatArray:
    """Return the grey values of a picture; shape (height, width)."""
    picture = matplotlib.image.imread(io.BytesIO(png), format="png")
    return 255.0 * picture[..., :3].astype(float) @ np.array(LUMA)


def different_blocks(one: FloatArray, other: FloatArray) -> int:
    """Return the number of blocks whose mean grey values differ visibly."""
    width, height = (length // BLOCK_PX for length in SIZE)
    means = [grey.reshape(height, BLOCK_PX, width, BLOCK_PX).mean(axis=(1, 3)) for grey in (one, other)]
    return int((np.abs(means[0] - means[1]) > MAX_GREY).sum())


@pytest.fixture(scope="module")
def shipped() -> FloatArray:
    return grey_values(picture_path("Drive", dark=False).read_bytes())


def test_the_picture_of_drive_looks_like_the_page(shipped: FloatArray, window: BrowserContext, server: Server) -> None:
    assert different_blocks(shipped, grey_values(take_picture(window, server, "Drive", dark=False))) <= MAX_BLOCKS


def test_a_picture_without_a_part_of_the_page_is_another_one(shipped: FloatArray) -> None:
    """The numbers below the heading are whitened, or everything is a block further down."""
    without = shipped.copy()
    without[120:200, 280:] = 255.0
    assert different_blocks(shipped, without) > MAX_BLOCKS
    assert different_blocks(shipped, np.roll(shipped, BLOCK_PX, axis=0)) > MAX_BLOCKS


def test_another_rasteriser_makes_the_same_picture(shipped: FloatArray) -> None:
    """Each pixel becomes the mean of its neighbours, as glyphs with softer edges have them."""
    around = [np.roll(shipped, (down, right), axis=(0, 1)) for down in (-1, 0, 1) for right in (-1, 0, 1)]
    assert different_blocks(shipped, np.mean(around, axis=0)) == 0
