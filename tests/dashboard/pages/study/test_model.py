import pytest

from railjoule.core import load_scenario
from railjoule.dashboard.pages.study.fields import MOST_VARIED, fields_that_vary
from railjoule.dashboard.pages.study.model import Progress, StudyModel

METRO = load_scenario("metro-with-limit")
TIME, LOAD = "timetable.travel_time_s", "vehicle.load_factor"


@pytest.fixture
def model() -> StudyModel:
    return StudyModel(METRO)


def test_a_range_is_typed_as_people_write_numbers(model: StudyModel) -> None:
    model.set_range(METRO, TIME, "2:55", "1\u202f000,5")
    assert model.over[TIME] == [175.0, 1000.5]
    assert model.refused == {}


@pytest.mark.parametrize(
    ("path", "low", "high", "told"),
    [
        (LOAD, "0", "7", "At most"),
        (LOAD, "-1", "1", "At least"),
        (LOAD, "much", "1", "Not a number."),
        (LOAD, "", "1", "Not a number."),
        (LOAD, "0.9", "0.1", "The range 0.9 to 0.1 begins above its end."),
        (TIME, "soon", "200", "is not a time"),
    ],
)
def test_a_wrong_range_is_told_and_changes_nothing(
    model: StudyModel, path: str, low: str, high: str, told: str
) -> None:
    before = dict(model.over)
    model.set_range(METRO, path, low, high)
    assert model.over == before
    assert told in model.refused[path]
    model.set_range(METRO, path, "0.5" if path == LOAD else "180", "1" if path == LOAD else "200")
    assert model.refused == {}


def test_fields_are_added_up_to_as_many_as_a_study_may_have(model: StudyModel) -> None:
    for path in fields_that_vary(METRO):
        model.add(METRO, path)
    assert len(model.over) == MOST_VARIED
    model.remove(LOAD)
    assert LOAD not in model.over
    model.add(METRO, "vehicle.name")
    model.add(METRO, "nothing.of.it")
    assert len(model.over) == MOST_VARIED - 1


@pytest.mark.parametrize(
    "over", [{LOAD: 3}, {LOAD: [1]}, {LOAD: [0, "1"]}, {LOAD: [0, float("nan")]}, {f"x{k}": [0, 1] for k in range(9)}]
)
def test_what_a_link_brings_is_looked_at(model: StudyModel, over: dict[str, object]) -> None:
    with pytest.raises(ValueError, match="must have"):
        model.checked("over", over)
    assert model.checked("over", {LOAD: [0, 1]}) == {LOAD: [0, 1]}


def test_the_rest_takes_as_long_as_the_rate_tells() -> None:
    assert Progress("running", 300, 1000, 70.0).left_s == 10.0
    assert Progress("running", 0, 1000, None).left_s is None
    assert Progress("stopping").is_under_way
    assert not Progress("failed").is_under_way
