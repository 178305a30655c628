"""README's picture looks like the page that it shows, with any font rasteriser.

Both are compared as grey values (0 to 255) of 64 by 43 blocks of 20 px. On 26 November 2026 two drawings of the page
differed by more than 8 in no block, the page blurred by 3 px in none, shifted down by a pixel in 16, and the picture
without the strategy `linear_reserve` in 50. `python -m tests.browser.pictures` takes the pictures again.
"""

import io

import matplotlib.image
import numpy as np
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


def test_the_picture_of_drive_looks_like_the_page(window: BrowserContext, server: Server) -> None:
    shipped = grey_values(picture_path("Drive", dark=False).read_bytes())
    assert different_blocks(shipped, grey_values(take_picture(window, server, "Drive", dark=False))) <= MAX_BLOCKS
