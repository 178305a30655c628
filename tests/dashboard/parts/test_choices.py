import pytest

from railjoule.dashboard.parts.choices import box, buttons, menu, over_time_buttons
from railjoule.dashboard.state.workbench import Workbench


@pytest.mark.parametrize(
    ("made", "owner", "field", "other"),
    [
        (over_time_buttons, "", "over_time", True),
        (lambda state: buttons(state, "compare_all", {"All": True, "Some": False}), "", "compare_all", False),
        (lambda state: box(state.motor, "precompensator", "On"), "motor", "precompensator", False),
        (
            lambda state: menu(state.motor, "flux", "Flux", {"a": "constant", "b": "least_loss"}),
            "motor",
            "flux",
            "least_loss",
        ),
    ],
)
def test_widget_and_field_follow_each_other(made, owner: str, field: str, other: object) -> None:
    state = Workbench()
    model, widget = getattr(state, owner) if owner else state, made(state)
    before = getattr(model, field)
    assert widget.value == before
    widget.value = other
    assert getattr(model, field) == other
    setattr(model, field, before)
    assert widget.value == before
