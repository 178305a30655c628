import pytest

from railjoule.core.studies.sweep import SweepTable
from railjoule.dashboard.pages.study.columns import columns_of, digits_for


def test_fields_come_first_with_units_and_results_as_the_other_pages_call_them(table: SweepTable) -> None:
    columns = columns_of(table.study)
    assert [column.words for column in columns.values()][:4] == [
        "Travel time, s",
        "Load factor, \u2013",
        "Recuperation factor, \u2013",
        "Energy, kWh",
    ]
    assert columns["timetable.travel_time_s"].told(151.25) == "151.2 s"
    assert columns["vehicle.load_factor"].told(0.5) == "0.500"
    # a joule in each second is 1/3600 Wh
    assert columns["price_of_time_w"].scale == pytest.approx(1 / 3600)


@pytest.mark.parametrize(("span", "digits"), [(80.0, 1), (1.0, 3), (2000.0, 0), (0.0, 2), (1e-12, 9)])
def test_decimals_tell_parts_of_a_span_apart(span: float, digits: int) -> None:
    assert digits_for(span) == digits
