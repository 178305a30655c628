from itertools import combinations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from railjoule.dashboard.charts.names import LINE_PX, Box, Label, Polyline, place_labels

WIDTH, HEIGHT = 800.0, 200.0


def crosses(line: Polyline, box: Box) -> bool:
    """Whether any point of a line, looked at far more closely than the routine does, lies in a box."""
    x, y = line
    steps = np.linspace(0, len(x) - 1, 40 * len(x))
    px, py = np.interp(steps, np.arange(len(x)), x), np.interp(steps, np.arange(len(x)), y)
    left, bottom, right, top = box
    return bool(np.any((px > left) & (px < right) & (py > bottom) & (py < top)))


def overlap(one: Box, other: Box) -> bool:
    return one[0] < other[2] and other[0] < one[2] and one[1] < other[3] and other[1] < one[3]


def check(lines: list[Polyline], boxes: list[Box | None], width: float = WIDTH, height: float = HEIGHT) -> None:
    placed = [box for box in boxes if box is not None]
    for left, bottom, right, top in placed:
        assert left >= -1e-9
        assert bottom >= -1e-9
        assert right <= width + 1e-9
        assert top <= height + 1e-9
    assert not any(crosses(line, box) for line in lines for box in placed)
    assert not any(overlap(one, other) for one, other in combinations(placed, 2))


def curves(seed: int, count: int, steps: bool = False) -> list[Polyline]:
    rng = np.random.default_rng(seed)
    lines = []
    for _ in range(count):
        x = np.sort(rng.uniform(0, 0.9 * WIDTH, rng.integers(3, 60)))
        y = np.clip(np.cumsum(rng.normal(0, 25, len(x))) + rng.uniform(0, HEIGHT), 0, HEIGHT)
        if steps:
            x, y = np.repeat(x, 2)[1:], np.repeat(y, 2)[:-1]
        lines.append((x, y))
    return lines


@settings(max_examples=150, deadline=None)
@given(seed=st.integers(0, 10**6), count=st.integers(1, 9), at_end=st.booleans(), steps=st.booleans())
def test_nothing_overlaps(seed: int, count: int, at_end: bool, steps: bool) -> None:
    lines = curves(seed, count, steps)
    labels = [Label(k, 30.0 + 17 * k, at_end=at_end) for k in range(count)]
    check(lines, place_labels(lines, labels, WIDTH, HEIGHT))


def test_lone_line_is_named_close_to_it() -> None:
    line = np.array([0.0, WIDTH]), np.array([100.0, 100.0])
    (box,) = place_labels([line], [Label(0, 60.0)], WIDTH, HEIGHT)
    assert min(abs(box[1] - 100), abs(box[3] - 100)) < LINE_PX


def test_ends_are_named_beside_them() -> None:
    lines = [(np.array([0.0, 700.0]), np.array([0.0, end])) for end in (100.0, 103.0, 199.0)]
    boxes = place_labels(lines, [Label(k, 60.0, at_end=True) for k in range(3)], WIDTH, HEIGHT)
    assert all(box is not None and box[0] > 700 for box in boxes)
    check(lines, boxes)


def test_end_without_room_is_named_along_its_line() -> None:
    line = np.array([0.0, 780.0]), np.array([100.0, 100.0])
    (box,) = place_labels([line], [Label(0, 60.0, at_end=True)], WIDTH, HEIGHT)
    assert box[2] < 780


def test_without_room_there_is_no_name() -> None:
    wall = [(np.array([0.0, WIDTH]), np.array([y, y])) for y in np.arange(0.0, HEIGHT, 10.0)]
    assert place_labels(wall, [Label(0, 60.0)], WIDTH, HEIGHT) == [None]
    assert place_labels([(np.array([0.0, 9.0]), np.zeros(2))], [Label(0, 5.0)], 5.0, 5.0) == [None]


def test_what_is_taken_stays_free() -> None:
    line = np.array([0.0, WIDTH]), np.array([100.0, 100.0])
    (free,) = place_labels([line], [Label(0, 60.0)], WIDTH, HEIGHT)
    assert free is not None
    (box,) = place_labels([line], [Label(0, 60.0)], WIDTH, HEIGHT, [free])
    assert box is not None
    assert not overlap(box, free)


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 10**6), x=st.floats(0, WIDTH), y=st.floats(0, HEIGHT))
def test_names_of_points_overlap_nothing(seed: int, x: float, y: float) -> None:
    lines = curves(seed, 2)
    labels = [Label(0, 90.0, point=(x, y)), Label(0, 50.0, point=(x, y)), Label(1, 40.0)]
    check(lines, place_labels(lines, labels, WIDTH, HEIGHT))
