"""What the page takes of the insides of its libraries is there in the installed releases; no browser is needed."""

import asyncio
import inspect
import re
from importlib.resources import files
from pathlib import Path
from types import SimpleNamespace
from unittest.mock import Mock

import bokeh
import panel as pn
import panel_material_ui as pmui
import param
import pytest
from bokeh.document import Document
from bokeh.models import Div
from bokeh.protocol import Protocol
from bokeh.server.connection import ServerConnection
from panel.io import document as messages
from panel.reactive import Syncable

from railjoule.dashboard.app import make_page, make_server
from railjoule.dashboard.insides import (
    LightComponent,
    SmallFile,
    Words,
    attach,
    first_html,
    freeze,
    frozen,
    leave_busy,
    models_of,
    tell_no_insides,
    thaw,
    thaw_unsearched,
    turns_of,
    write_all_messages,
)
from railjoule.dashboard.server.options import ServerOptions
from railjoule.dashboard.shell.shell import empty_page

SCRIPTS = files("railjoule.assets") / "scripts"
PANEL, BOKEH = Path(pn.__file__).parent, Path(bokeh.__file__).parent


def script(name: str) -> str:
    return (SCRIPTS / f"{name}.js").read_text(encoding="utf-8")


def test_the_bundle_of_panel_holds_each_text_that_follow_replaces_once() -> None:
    bundle = (PANEL / "dist" / "panel.min.js").read_text(encoding="utf-8")
    texts = re.findall(r'^ {4}\["([^"]+)", ', script("follow"), re.M)
    assert len(texts) == 3
    assert {text: bundle.count(text) for text in texts} == dict.fromkeys(texts, 1)


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


@pytest.mark.parametrize("library", [bokeh, pn, param, pmui])
def test_the_release_is_one_that_this_was_tried_with(library: object) -> None:
    tried = {"bokeh": "3.9.", "panel": "1.9.", "panel_material_ui": "0.16.", "param": "2.4."}
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


def test_a_closed_page_takes_no_turn() -> None:
    document = Document()
    turn = turns_of(document)
    turn(lambda: None)
    assert len(document.session_callbacks) == 1
    document._session_context = lambda: SimpleNamespace(destroyed=True)
    turn(lambda: None)
    assert len(document.session_callbacks) == 1
