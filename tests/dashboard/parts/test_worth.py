import pytest

from railjoule.dashboard.parts.worth import yearly_saving


def test_a_year_of_savings() -> None:
    # 2 kWh, 100 trains a day: 200 kWh a day, 73 MWh a year
    saving = yearly_saving(2.0, 100, 0.2, 0.4)
    assert saving == pytest.approx((73.0, 14_600.0, 29.2))
    assert yearly_saving(-2.0, 100, 0.2, 0.4) == pytest.approx((-73.0, -14_600.0, -29.2))
    assert yearly_saving(2.0, 0, 0.2, 0.4) == (0.0, 0.0, 0.0)
