"""What the page takes of the insides of its libraries is there in the installed releases; no browser is needed."""

import ast
import asyncio
import inspect
import json
import re
from datetime import date
from importlib.resources import files
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from unittest.mock import Mock

import bokeh
import panel as pn
import panel_material_ui as pmui
import param
import pytest
from bokeh.core.has_props import HasProps, MetaHasProps, is_DataModel
from bokeh.core.property.descriptors import PropertyDescriptor, UnsetValueError
from bokeh.core.serialization import Serializer
from bokeh.document import Document
from bokeh.document.locking import UnlockedDocumentProxy
from bokeh.model import Model
from bokeh.model import util as searching
from bokeh.models import Button, Column, ColumnDataSource, CustomJS, DatePicker, Div, GlyphRenderer, Plot, Slider, Span
from bokeh.models.widgets import Slider as FloatSlider
from bokeh.plotting import figure
from bokeh.protocol import Protocol
from bokeh.server.connection import ServerConnection
from panel.io import document as messages
from panel.io.state import set_curdoc
from panel.reactive import Syncable
from panel.viewable import Viewable
from panel_material_ui.theme import MaterialDesign
from tornado.httputil import HTTPHeaders, HTTPServerRequest, RequestStartLine

from railjoule import dashboard
from railjoule.dashboard import insides
from railjoule.dashboard.app import make_page, make_server
from railjoule.dashboard.insides import (
    LONGEST_REMEMBERED,
    MOST_REMEMBERED,
    READ,
    LightComponent,
    PageAnswer,
    SmallFile,
    Words,
    application_of,
    attach,
    begin_as,
    first_html,
    freeze,
    frozen,
    leave_busy,
    models_of,
    name_sheets,
    page_of_token,
    server_context,
    session_document,
    tell_no_insides,
    thaw,
    thaw_unsearched,
    token_of,
    write_all_messages,
    written_down,
)
from railjoule.dashboard.server.options import ServerOptions
from railjoule.dashboard.shell.shell import empty_page

SCRIPTS = files("railjoule.assets") / "scripts"
PANEL, BOKEH = Path(pn.__file__).parent, Path(bokeh.__file__).parent


def script(name: str) -> str:
    return (SCRIPTS / f"{name}.js").read_text(encoding="utf-8")


def test_follow_finds_each_text_that_it_mends_once() -> None:
    source = (PANEL / "models" / "react_component.ts").read_text(encoding="utf-8")
    code = source[source.index("_render_code(") :]
    texts = [ast.literal_eval(found) for found in re.findall(r'^ {4}\[("[^"]+"), ', script("follow"), re.M)]
    assert len(texts) == 3
    assert {text: code.count(text) for text in texts} == dict.fromkeys(texts, 1)


def test_the_bundle_of_panel_holds_the_same_texts() -> None:
    bundle = (PANEL / "dist" / "panel.min.js").read_text(encoding="utf-8")
    for text in re.findall(r'^ {4}\["([^"]+)", ', script("follow"), re.M):
        assert bundle.count(text) == 1, text


def needed_names() -> list[str]:
    """Return what the mends look for before they change it."""
    calls = re.findall(r"needed\(\s*\w+,([^()]*)\)", script("mends"))
    return sorted({name for call in calls for name in re.findall(r'"(\w+)"', call)})


def test_the_mends_find_all_that_they_change() -> None:
    sources = [*(PANEL / "models").glob("*.ts"), BOKEH / "server" / "static" / "js" / "bokeh.js"]
    text = "\n".join(source.read_text(encoding="utf-8") for source in sources)
    names = needed_names()
    assert {"_compute_layout", "_layout_data", "resize_layout"} <= set(names)
    missing = [name for name in [*names, "layoutable_views"] if not re.search(rf"\b{name}\(.*\).*{{", text)]
    assert missing == []
    assert "press_threshold" in text
    assert "_get_css_value" in text
    for model in ("panel.models.esm", "panel.models.plotly", "panel.models.layout"):
        assert f'"{model}"' in text


def listeners() -> int:
    """Return how many listen to whether the process is busy."""
    return len(pn.state._param__private.watchers.get("busy", {}).get("value", []))


def test_a_page_listens_to_the_process_until_it_leaves() -> None:
    before = listeners()
    page = pmui.Page()
    assert listeners() == before + 1
    leave_busy(page)
    assert listeners() == before
    assert "busy" not in page._param__private.refs


def test_a_page_may_leave_colours_to_others() -> None:
    root = pmui.Page().get_root(Document())
    assert "_custom_theme" in root.data.properties()
    source = Path(pmui.__file__).parent / "utils.js"
    assert "_custom_theme" in source.read_text(encoding="utf-8")


def test_a_document_is_told_where_style_sheets_are() -> None:
    document = Document()
    name_sheets(document)
    assert document.template_variables["dist_url"].endswith("static/extensions/panel/")


def test_a_file_that_is_too_large_is_told_by_status() -> None:
    told: list[bool] = []
    SmallFile(lambda: told.append(True))._handle_msg({"status": "error"})
    assert told == [True]
    assert 'msg["status"]' in inspect.getsource(pmui.FileInput._handle_msg)


def test_a_pane_sends_its_text_alone() -> None:
    assert list(inspect.signature(pn.pane.HTML._update).parameters) == ["self", "ref", "model"]
    document, words = Document(), Words("<b>1</b>", stylesheets=["b { color: red }"])
    other = Words("", stylesheets=["b { color: red }"])
    root, same = words.get_root(document), other.get_root(document)
    sent: list[set[str]] = []
    document.add_root(root)
    document.on_change(lambda event: sent.append({event.attr}))
    words.object = "<b>2</b>"
    assert root.text == "<plaintext><b>2</b>"
    assert sent in ([], [{"text"}])
    assert root.stylesheets[-1] is same.stylesheets[-1]


def test_events_are_no_longer_counted() -> None:
    names = "_add_busy_event", "_remove_busy_event"
    assert all(f"state.{name}(" in inspect.getsource(Syncable._process_events) for name in names)
    assert all(callable(getattr(type(pn.state), name)) for name in names)


def test_a_light_component_is_heard_sooner_than_others() -> None:
    assert 0 < LightComponent._debounce < Syncable._debounce
    assert "_debounce" in inspect.getsource(Syncable._server_change)


def test_a_frozen_document_finds_new_models_when_it_thaws() -> None:
    document, column = Document(), pn.Column()
    root = column.get_root(document)
    document.add_root(root)
    assert models_of(column) == [root]
    freeze(document)
    assert frozen(document) == 1
    new = Div(text="new")
    root.children = [new]
    assert new.id not in document.models
    attach(document, new)
    assert document.get_model_by_id(new.id) is new
    thaw_unsearched(document)
    assert frozen(document) == 0
    freeze(document)
    later = Div(text="later")
    root.children = [new, later]
    thaw(document, 0)
    assert document.get_model_by_id(later.id) is later


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


def test_a_theme_goes_before_a_default_that_is_remembered() -> None:
    before = Div().visible
    themed = Div()
    themed.apply_theme({"visible": not before})
    assert (themed.visible, Div().visible) == (not before, before)


def test_defaults_that_can_be_changed_are_not_shared() -> None:
    one, other = Div(), Div()
    one.tags.append("mine")
    assert other.tags == Div().tags == []


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


def test_a_model_that_lacks_something_is_told_as_the_library_does() -> None:
    with pytest.raises(UnsetValueError, match="glyph"):
        written(GlyphRenderer(data_source=ColumnDataSource()))


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


def test_kinds_of_components_are_defined_as_the_library_does() -> None:
    kinds = [kind for kind in Model.model_class_reverse_map.values() if is_DataModel(kind)]
    assert len(kinds) > 20
    ours = Serializer._encoders[MetaHasProps]
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(Serializer._encoders, MetaHasProps, library(ours))
        expected = Serializer(deferred=False).encode(kinds)
    for _ in range(2):
        serializer = Serializer(deferred=False)
        assert serializer.encode(kinds) == expected
        # the second time in a message, a name will do
        assert serializer.encode(kinds[0]) == {"id": kinds[0].__qualified_model__}


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


def test_what_one_part_says_of_a_parameter_counts_where_it_is_written_down(monkeypatch: pytest.MonkeyPatch) -> None:
    own, other = pmui.Button(), pmui.Button()
    own.param.href.precedence = -1
    for part in (own, other):
        monkeypatch.setitem(vars(insides), "READ", {id(part)})
        assert part.param["href"].precedence == (-1 if part is own else pmui.Button.param.href.precedence)


@pytest.mark.parametrize("kind", [pn.Column, pn.pane.HTML, pmui.Button])
def test_style_sheets_of_a_part_are_those_of_the_library(kind: type[Syncable]) -> None:
    design, part = MaterialDesign(theme="default"), kind()
    ours = MaterialDesign._get_modifiers.__func__
    expected = library(ours)(MaterialDesign, part, design.theme)
    for _ in range(2):
        found = MaterialDesign._get_modifiers(part, theme=design.theme)
        assert found == expected
        # what asks changes what it is given
        found[0].clear()


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


@pytest.mark.parametrize("kind", [pn.Column, pn.pane.HTML, pmui.Button, pmui.Select])
def test_what_a_part_shares_with_the_browser_is_what_the_library_shares(kind: type[Syncable]) -> None:
    part = kind(margin=3)
    # the library's own words: all that is shared and is not None
    names = [name for name in part.param if name in part._synced_params]
    expected = {name: getattr(part, name) for name in names if getattr(part, name) is not None}
    assert list(Syncable._init_params(part).items()) == list(expected.items())
    assert expected["margin"] == 3


def test_nobody_searches_the_page_for_what_it_never_has() -> None:
    searched = {hook.__name__ for hook in Viewable._preprocessing_hooks}
    assert searched.isdisjoint({"link_param_method", "link_axes", "find_links"})
    sources = [path.read_text(encoding="utf-8") for path in Path(dashboard.__file__).parent.rglob("*.py")]
    assert not [word for word in ("pn.Param", "ParamMethod", "pane.HoloViews", "pn.bind") if word in "".join(sources)]


def test_a_script_is_asked_for_below_the_path_of_its_page() -> None:
    path = pmui.Button._bundle_path
    found = []
    for below in ("", "/tools", ""):
        with set_curdoc(Document()):
            pn.state.rel_path = below
            found.append(pmui.Button._component_resource_path(path, True))
    assert found[0] == found[2]
    assert found[1] == f"/tools/{found[0]}"


def test_a_light_component_has_its_script_at_hand() -> None:
    class Light(LightComponent):
        _esm = "export function render() { return null }"

    assert (Light._bundle_path, Light._esm_path()) == (None, None)
    assert Light._render_esm() == Light._esm


def test_a_pane_of_words_has_no_row_of_its_own() -> None:
    words = Words("here", visible=False)
    assert words.layout is None
    words.visible, words.margin = True, 3
    model = pn.Column(words).get_root()
    assert (model.children[0].visible, model.children[0].margin) == (True, 3)


def request(address: str) -> HTTPServerRequest:
    line = RequestStartLine("GET", address, "HTTP/1.1")
    return HTTPServerRequest(start_line=line, headers=HTTPHeaders({"Host": "localhost"}), connection=Mock())


def test_what_a_page_asks_for_is_in_its_token() -> None:
    server = make_server(ServerOptions(port=0))
    try:
        asked = request("/?v=1&page=Drive")
        context = server_context(server)
        handler = PageAnswer(application_of(server), asked, application_context=context, bokeh_websocket_path="/ws")
        token = token_of(handler)
        assert page_of_token(token) == "/?v=1&page=Drive"
        begun = request("/ws")
        begin_as(begun, page_of_token(token))
        assert (begun.path, begun.query, begun.uri) == ("/", "v=1&page=Drive", "/?v=1&page=Drive")
    finally:
        server.stop()


def test_what_a_browser_gets_first_does_not_depend_on_the_page() -> None:
    server = make_server(ServerOptions(port=0))
    try:
        texts = [first_html(server, page, "@") for page in (empty_page(), make_page())]
    finally:
        server.stop()
    ids = re.compile(r"p\d{4,}|[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}")
    plain, whole = (ids.sub("ID", text) for text in texts)
    assert plain == whole
    assert plain.count('"token":"@"') == 1


def test_what_stands_for_a_document_names_it() -> None:
    document = Document()
    assert session_document(UnlockedDocumentProxy(document)) is session_document(document) is document


def test_a_document_is_written_down_with_its_roots() -> None:
    document = Document()
    root = Div(text="here")
    document.add_root(root)
    docs, item = written_down(document)
    assert len(docs) == 1
    assert list(item.to_json()["roots"]) == [root.id]
    # the process has defined dozens of components by now, none of which stands in this document
    assert [doc["defs"] for doc in docs.values()] == [[]]
    drawn = Document()
    drawn.add_root(pmui.Button(label="here").get_root())
    docs, _ = written_down(drawn)
    assert "Button1" in {one["name"] for doc in docs.values() for one in doc["defs"]}


@pytest.mark.parametrize("library", [bokeh, pn, pmui])
def test_the_release_is_one_that_this_was_tried_with(library: object) -> None:
    tried = {"bokeh": "3.9.", "panel": "1.9.", "panel_material_ui": "0.16."}
    name = getattr(library, "__name__")  # noqa: B009
    assert str(getattr(library, "__version__")).startswith(tried[name])  # noqa: B009


def test_an_answer_to_a_message_that_failed_holds_no_traceback() -> None:
    tell_no_insides()
    connection = ServerConnection(Protocol(), None, None, SimpleNamespace(subscribe=lambda _: None))
    message = Protocol().create("SERVER-INFO-REQ")
    try:
        raise ValueError(f"of {__file__}")
    except ValueError as failure:
        answer = connection.error(message, repr(failure))
    assert answer.content == {
        "text": "The server could not take a change; its log describes the error.",
        "traceback": None,
    }
    assert answer.header["reqid"] == message.header["msgid"]


def test_a_message_that_came_while_another_was_written_is_written_too(monkeypatch: pytest.MonkeyPatch) -> None:
    write_all_messages()
    document, connection, written = Document(), Mock(), list[str]()
    connection.protocol.create = lambda _, events: events[0]

    async def main() -> None:
        sent = asyncio.get_running_loop().create_future()

        def send(_: object, msg: str) -> list[asyncio.Future[None]]:
            written.append(msg)
            return [sent]

        monkeypatch.setitem(messages.extra_socket_handlers, type(connection._socket), send)
        messages.schedule_write_events(document, [connection], ["first"])
        await asyncio.sleep(0)
        # the first is told that it is sent, and goes on before whatever begins from now on
        sent.set_result(None)
        messages.schedule_write_events(document, [connection], ["second"])
        for _ in range(5):
            await asyncio.sleep(0)

    asyncio.run(main())
    assert written == ["first", "second"]
    assert document not in messages._WRITE_BLOCK
