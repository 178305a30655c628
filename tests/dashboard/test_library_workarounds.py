"""Each workaround still cures a defect of the installed release; a test that fails means that it may go."""

import asyncio
import datetime as dt
import gc
import html
import inspect
import re
from importlib.resources import files
from pathlib import Path
from types import SimpleNamespace
from unittest.mock import Mock

import bokeh
import panel as pn
import panel_material_ui as pmui
import pytest
from bokeh.document import Document
from bokeh.document.events import ModelChangedEvent
from bokeh.document.locking import UnlockedDocumentProxy
from bokeh.embed.util import standalone_docs_json_and_render_items
from bokeh.model import Model
from bokeh.models import Div
from bokeh.protocol import Protocol
from bokeh.server.connection import ServerConnection
from markupsafe import Markup
from panel.custom import JSComponent
from panel.io import document as messages
from panel.io.resources import LOCAL_DIST

from railjoule.dashboard.app import make_page, make_server
from railjoule.dashboard.library_workarounds import (
    FAILED,
    HtmlPane,
    SmallFile,
    busy_watchers,
    collect_garbage_rarely,
    document_json,
    first_html,
    frozen,
    hide_tracebacks,
    leave_busy,
    make_turns,
    note_pulled,
    session_document,
    thaw,
    write_all_messages,
)
from railjoule.dashboard.server.options import ServerOptions
from railjoule.dashboard.shell.shell import empty_page

SCRIPTS = files("railjoule.assets") / "scripts"
PANEL, BOKEH = Path(pn.__file__).parent, Path(bokeh.__file__).parent


def script(name: str) -> str:
    return (SCRIPTS / f"{name}.js").read_text(encoding="utf-8")


def test_the_repairs_in_the_browser_find_all_that_they_change() -> None:
    repaired = re.findall(r'repair\("([^"]+)", "(\w+)", "(\w+)"', script("repairs"))
    assert len(repaired) == 4
    text = (BOKEH / "server" / "static" / "js" / "bokeh.js").read_text(encoding="utf-8")
    for module, kind, name in repaired:
        body = text.partition(f"/* {module}.js */")[2].partition("\n},\n")[0]
        assert f"class {kind} " in body
        assert re.search(rf"^ +{name}\(.*\) {{$|^ +async {name}\(", body, re.MULTILINE), name


def test_a_page_follows_the_process_unless_it_is_kept_from_it() -> None:
    before = busy_watchers()
    page = pmui.Page()
    assert len(busy_watchers()) == len(before) + 1
    with leave_busy():
        other = pmui.Page()
    assert len(busy_watchers()) == len(before) + 1
    assert page is not other


def test_a_file_that_is_too_large_is_reported_by_status() -> None:
    refused: list[bool] = []
    SmallFile(lambda: refused.append(True))._handle_msg({"status": "error"})
    assert refused == [True]
    assert 'msg["status"]' in inspect.getsource(pmui.FileInput._handle_msg)


def test_panel_still_escapes_markup_twice() -> None:
    text = Markup("<b>1 &lt; 2</b>")
    assert html.unescape(pn.pane.HTML(text)._transform_object(text)["object"]) != text
    assert html.unescape(HtmlPane(text)._transform_object(text)["object"]) == text


def test_panel_still_sends_a_style_sheet_with_each_pane() -> None:
    def last_sheets(kind: type[pn.pane.HTML]) -> list[object]:
        document = Document()
        return [kind("", stylesheets=["b { color: red }"]).get_root(document).stylesheets[-1] for _ in range(2)]

    stock, shared = last_sheets(pn.pane.HTML), last_sheets(HtmlPane)
    assert not isinstance(stock[0], Model)
    assert isinstance(shared[0], Model)
    assert shared[0] is shared[1]


def test_a_changed_pane_of_panel_still_loses_its_sheets_while_it_has_no_document() -> None:
    def urls(kind: type[pn.pane.HTML]) -> set[str]:
        document = Document()
        document.template_variables["dist_url"] = "static/extensions/panel/"
        pane = kind("1")
        root = pane.get_root(document)
        # as where the document is frozen: the model is no part of it yet
        assert root.document is None
        pane.object = "2"
        return {sheet.url for sheet in root.stylesheets if hasattr(sheet, "url")}

    assert any(url.startswith("https:") for url in urls(pn.pane.HTML))
    assert not any(url.startswith("https:") for url in urls(HtmlPane))


def test_panel_still_does_not_say_where_its_sheets_are_until_it_renders_a_page() -> None:
    document = Document()
    pmui.Page().get_root(document)
    assert "dist_url" not in document.template_variables
    empty_page().get_root(document)
    assert document.template_variables["dist_url"] == LOCAL_DIST


def test_bokeh_still_leaves_a_document_frozen_after_an_error() -> None:
    document = Document()

    def fail() -> None:
        with document.models.freeze():
            raise ValueError

    with pytest.raises(ValueError):  # noqa: PT011
        fail()
    assert frozen(document) == 1
    thaw(document, 0)
    assert frozen(document) == 0


def test_bokeh_still_hands_out_documents_that_are_not_the_session_s() -> None:
    document = Document()
    proxy = UnlockedDocumentProxy(document)
    assert proxy != document
    assert session_document(proxy) is session_document(document) is document


def test_bokeh_still_writes_down_models_that_a_document_does_not_contain() -> None:
    class Elsewhere(JSComponent):
        _esm = "export function render() {}"

    Elsewhere().get_root(Document())
    document = Document()
    document.add_root(Div(text="one"))
    whole, _ = standalone_docs_json_and_render_items(document)
    needed, _ = document_json(document)
    assert [len(doc.get("defs", [])) > 0 for doc in whole.values()] == [True]
    assert [doc["defs"] for doc in needed.values()] == [[]]


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


@pytest.mark.parametrize("library", [bokeh, pn, pmui])
def test_the_release_is_one_that_this_was_tried_with(library: object) -> None:
    tried = {"bokeh": "3.9.", "panel": "1.9.", "panel_material_ui": "0.16."}
    name = getattr(library, "__name__")  # noqa: B009
    assert str(getattr(library, "__version__")).startswith(tried[name])  # noqa: B009


def test_an_answer_to_a_message_that_failed_holds_no_traceback() -> None:
    hide_tracebacks()
    connection = ServerConnection(Protocol(), None, None, SimpleNamespace(subscribe=lambda _: None))
    message = Protocol().create("SERVER-INFO-REQ")
    try:
        raise ValueError(f"of {__file__}")
    except ValueError as failure:
        answer = connection.error(message, repr(failure))
        stock = Protocol().create("ERROR", "1", repr(failure))
    assert Path(__file__).name in stock.content["traceback"]
    assert answer.content == {"text": FAILED, "traceback": None}
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
        # the first gets its answer, and goes on before whatever begins from now on
        sent.set_result(None)
        messages.schedule_write_events(document, [connection], ["second"])
        for _ in range(5):
            await asyncio.sleep(0)

    asyncio.run(main())
    assert written == ["first", "second"]
    assert document not in messages._WRITE_BLOCK


def test_a_closed_page_takes_no_turn() -> None:
    document, context = Document(), SimpleNamespace(destroyed=False)
    document._session_context = lambda: context
    turn = make_turns(document)
    turn(lambda: None)
    assert len(document.session_callbacks) == 1
    # as `panel.io.document._destroy_document` does
    context.destroyed, document._session_context = True, None
    turn(lambda: None)
    assert len(document.session_callbacks) == 1


def test_panel_still_sends_nothing_of_what_changes_between_the_pull_of_a_page_and_its_start() -> None:
    def sent(*, is_noted: bool) -> list[object]:
        document, pulled = Document(), Protocol().create("PULL-DOC-REQ")
        document.add_root(div := Div(text="as it is pulled"))
        events: list[object] = []
        document.on_change(events.append)
        if is_noted:
            session = SimpleNamespace(document=document)
            note_pulled(SimpleNamespace(connection=SimpleNamespace(session=session)), pulled)
        with messages.hold(document):
            div.text = "changed before the page has started"
        # the turn in which Panel lets go of what it holds
        for turn in document.session_callbacks:
            turn.callback()
        return [event.new for event in events if isinstance(event, ModelChangedEvent)]

    assert sent(is_noted=False) == []
    assert sent(is_noted=True) == ["changed before the page has started"]


def test_panel_still_searches_for_garbage_soon_after_each_page_that_closes(monkeypatch: pytest.MonkeyPatch) -> None:
    """The thresholds that are set beside it are those of Python, not of a library: they have no test."""
    searches: list[dt.datetime] = []
    monkeypatch.setattr(type(pn.state), "schedule_task", lambda _, name, call, at: searches.append(at))
    monkeypatch.setattr(messages, "GC_DEBOUNCE", messages.GC_DEBOUNCE)

    def seconds_to_the_search() -> float:
        document = Document()
        document.destroy = None
        messages._destroy_document(document, None)
        return (searches[-1] - dt.datetime.now()).total_seconds()

    thresholds = gc.get_threshold()
    try:
        assert seconds_to_the_search() == pytest.approx(5.0, abs=1.0)
        collect_garbage_rarely()
        assert seconds_to_the_search() == pytest.approx(30.0, abs=1.0)
    finally:
        gc.set_threshold(*thresholds)
    # and no setting changes that
    assert [name for name in pn.config.param if "gc" in name or "garbage" in name] == []
