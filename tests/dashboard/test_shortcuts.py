"""Shortcuts do what the functions of the libraries do that they replace."""

import inspect
import json
import re
from datetime import date
from pathlib import Path
from typing import Any

import panel as pn
import panel_material_ui as pmui
import param
import pytest
from bokeh.core.has_props import HasProps
from bokeh.core.property.descriptors import PropertyDescriptor
from bokeh.core.serialization import Serializer
from bokeh.model import Model
from bokeh.model import util as searching
from bokeh.models import Button, Column, ColumnDataSource, CustomJS, DatePicker, Div, Plot, Slider, Span
from bokeh.models.widgets import Slider as FloatSlider
from bokeh.plotting import figure
from panel.viewable import Viewable

# puts the shortcuts in their places
import railjoule.dashboard.app  # noqa: F401
from railjoule import dashboard
from railjoule.dashboard.shortcuts import LONGEST_REMEMBERED, MOST_REMEMBERED, READ


def test_defaults_that_are_remembered_are_those_of_the_library() -> None:
    remembered, own = PropertyDescriptor._get_default, PropertyDescriptor.has_unstable_default
    for kind in (Button, Column, Div, FloatSlider, figure):
        with pytest.MonkeyPatch.context() as patch:
            # what insides.py has put before the library's own, which it keeps
            for name, ours in (("_get_default", remembered), ("has_unstable_default", own)):
                patch.setattr(PropertyDescriptor, name, ours.__closure__[-1].cell_contents)
            expected = plain_defaults(kind())
        for _ in range(2):
            assert plain_defaults(kind()) == expected


def plain_defaults(model: Model) -> dict[str, object]:
    """Return what a model has by default, without what is made for each anew."""
    found = model.properties_with_values(include_undefined=True)
    return {name: value for name, value in found.items() if not isinstance(value, Model | list | dict)}


def library(ours: Any) -> Any:
    """Return what insides.py has put one of its functions before."""
    return ours.replaces


def a_figure() -> figure:
    """Return a figure with models of many kinds, some of whose lists and dicts were changed."""
    f = figure(x_axis_label="km", tools="pan,box_zoom,hover")
    f.line("x", "y", source=ColumnDataSource({"x": [1.0, 2.0], "y": [3.0, 4.0]}), line_dash="dashed")
    f.scatter([1, 2], [3, 4], size=6)
    f.add_layout(Span(location=1.0, dimension="height"))
    f.x_range.tags.append("mine")
    f.js_on_event("tap", CustomJS(args={"other": f.y_range}, code="other"))
    f.styles["color"] = "red"
    return f


def test_a_model_is_written_down_as_the_library_does() -> None:
    with pytest.MonkeyPatch.context() as patch:
        for name in ("__init__", "query_properties_with_values"):
            patch.setattr(HasProps, name, library(getattr(HasProps, name)))
        expected = written(a_figure())
    assert written(a_figure()) == expected
    # what the library makes, ours writes down in the same way, and the other way round
    one = a_figure()
    ours = written(one)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(HasProps, "query_properties_with_values", library(HasProps.query_properties_with_values))
        assert written(one) == ours


def written(model: Model) -> str:
    """Return a model and all that it holds as text, with numbers from 0 on for ids."""
    text = json.dumps(Serializer(deferred=False).encode(model))
    ids = {found: str(place) for place, found in enumerate(dict.fromkeys(re.findall(r"p\d{4,}", text)))}
    return re.sub(r"p\d{4,}", lambda found: ids[found[0]], text)


def test_a_search_finds_the_models_that_the_library_finds() -> None:
    model = pn.Column(pmui.Button(label="here"), pn.pane.HTML("there"), a_figure()).get_root()
    name = "visit_immediate_value_references"
    found = model.references()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(searching, name, library(getattr(searching, name)))
        assert model.references() == found
    assert {type(one).__name__ for one in found} >= {"Button1", "HTML", "CustomJS", "Span", "PanTool"}


def test_an_empty_list_of_a_model_is_its_own() -> None:
    one, other, heard = Div(), Div(), list[str]()
    one.on_change("tags", lambda name, *_: heard.append(name))
    one.tags.append("mine")
    one.tags += ["more"]
    assert (one.tags, other.tags, heard) == (["mine", "more"], [], ["tags", "tags"])
    assert one.properties_with_values(include_defaults=False)["tags"] == ["mine", "more"]
    assert "tags" not in other.properties_with_values(include_defaults=False)


def test_a_value_that_was_right_once_is_right_again_and_a_wrong_one_stays_wrong() -> None:
    for _ in range(2):
        assert Div(width=5).width == 5
        # each a value of its own, although Python takes them for equal
        assert (type(Span(location=1).location), type(Span(location=1.0).location)) == (int, float)
        with pytest.raises(ValueError, match="width"):
            Div(width=True)
        with pytest.raises(ValueError, match="sizing_mode"):
            Div(sizing_mode="anyhow")
        # what the library changes on the way is changed each time
        assert Slider(start=0, end=1, value=0.5, format="0a").format == "0a"
        assert DatePicker(value=date(2026, 1, 2)).value == "2026-01-02"


def test_values_without_end_are_not_remembered() -> None:
    for number in range(500):
        assert Div(text=f"text {number}").text == f"text {number}"
    remembered = vars(Div.lookup("text").property)["_railjoule_valid"]
    assert 0 < len(remembered) <= MOST_REMEMBERED
    long = "x" * (LONGEST_REMEMBERED + 1)
    other = Plot.lookup("name").property
    Plot(name=long)
    assert (str, long) not in vars(other).get("_railjoule_valid", set())


def test_a_part_is_written_down_without_copies_of_its_parameters() -> None:
    part = pmui.Select(label="here", options=["a", "b"], value="a")
    before = set(part._param__private.params)
    model = part.get_root()
    assert (model.data.label, model.data.value) == ("here", "a")
    copied = set(part._param__private.params) - before
    # a few of those that are watched; the library copies all 50
    assert len(copied) < len(list(part.param)) / 2
    part.param.value.constant = True
    assert not pmui.Select.param.value.constant
    assert set() == READ


def test_a_parameter_of_one_object_is_the_copy_of_the_library() -> None:
    class Two(param.Parameterized):
        number = param.Number(1.0, bounds=(0.0, 2.0))
        choice = param.Selector(default="a", objects=["a", "b"])

    for name in ("number", "choice"):
        of_class, of_object = Two.param[name], Two().param[name]
        slots = [slot for slot in type(of_class)._all_slots_ if slot not in ("owner", "watchers")]
        assert [getattr(of_object, slot) for slot in slots] == [getattr(of_class, slot) for slot in slots]
    one, other = Two(), Two()
    one.param.number.bounds = (0.0, 9.0)
    one.param.choice.objects.append("c")
    assert one.param.number.owner is one
    assert (other.param.number.bounds, Two.param.number.bounds) == ((0.0, 2.0), (0.0, 2.0))
    assert (list(other.param.choice.objects), list(Two.param.choice.objects)) == (["a", "b"], ["a", "b"])
    assert "_instantiate_param_obj(" in inspect.getsource(library(param.parameterized._instantiated_parameter))


def test_nobody_searches_the_page_for_what_it_never_has() -> None:
    searched = {hook.__name__ for hook in Viewable._preprocessing_hooks}
    assert searched.isdisjoint({"link_param_method", "link_axes", "find_links"})
    sources = [path.read_text(encoding="utf-8") for path in Path(dashboard.__file__).parent.rglob("*.py")]
    assert not [word for word in ("pn.Param", "ParamMethod", "pane.HoloViews", "pn.bind") if word in "".join(sources)]
