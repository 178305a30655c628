import param
import pytest
from bokeh.document import Document

from railjoule.dashboard.parts.choices import box, buttons, menu, over_time_buttons
from railjoule.dashboard.workbench import Workbench


@pytest.mark.parametrize(
    ("made", "owner", "field", "other"),
    [
        (over_time_buttons, "", "over_time", True),
        (
            lambda state: buttons(state.pages["Compare"], "compare_all", {"All": True, "Some": False}),
            "Compare",
            "compare_all",
            False,
        ),
        (lambda state: box(state.pages["Motor"], "precompensator", "On"), "Motor", "precompensator", False),
        (
            lambda state: menu(state.pages["Motor"], "flux", "Flux", {"a": "constant", "b": "min_loss"}),
            "Motor",
            "flux",
            "min_loss",
        ),
    ],
)
def test_widget_and_field_follow_each_other(made, owner: str, field: str, other: object) -> None:
    state = Workbench()
    model, widget = state.pages[owner] if owner else state, made(state)
    before = getattr(model, field)
    assert widget.value == before
    widget.value = other
    assert getattr(model, field) == other
    setattr(model, field, before)
    assert widget.value == before


class Choice(param.Parameterized):
    number = param.Integer(default=3, allow_None=True)


@pytest.mark.parametrize(("given", "taken"), [(None, 2), (7, 2), (3, 3), (2, 2)])
def test_a_value_that_the_widget_does_not_offer_ends_with_one_it_does(given: int | None, taken: int) -> None:
    # in a document Panel puts the first option in the place of a value that is none, while it hears of that value
    model = Choice()
    widget = buttons(model, "number", {"two": 2, "three": 3})
    widget.get_root(Document())
    model.number = given
    assert widget.value == model.number == taken
    widget.value = given
    assert widget.value == model.number == taken
