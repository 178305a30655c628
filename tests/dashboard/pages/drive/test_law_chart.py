import numpy as np

from railjoule.core import load_scenario
from railjoule.core.strategies import prepare_task
from railjoule.core.strategies.bellman import bellman_with_law
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.pages.drive.law_chart import COLUMNS, ROWS, diverging, sampled


def test_the_map_shows_the_law() -> None:
    run, law = bellman_with_law(prepare_task(load_scenario("liashenko-0")))
    image, top = sampled(law)
    assert image.shape == (ROWS, COLUMNS)
    assert top == law.speed_ms.max()
    # full traction at low speed behind the start, full braking cannot be needed there
    assert image[1, 5] > 0.99
    # too fast to stop any more: the end cannot be reached
    assert np.isnan(image[-1, -2])
    assert np.nanmin(image) >= -1 - 1e-9
    assert np.nanmax(image) <= 1 + 1e-9
    assert run.strategy == "bellman"


def test_colours_go_from_braking_over_coasting_to_traction() -> None:
    palette = Palette(dark=True)
    colours = diverging(palette)
    assert colours[0].lower() == palette.tokens["driven"].lower()
    assert colours[len(colours) // 2].lower() == palette.tokens["coast"].lower()
    assert colours[-1].lower() == palette.tokens["accent"].lower()
