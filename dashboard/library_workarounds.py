"""Workarounds for defects of Panel, panel-material-ui and Bokeh, and the only use of their private API.

Tried with panel 1.9.4, panel-material-ui 0.16.6 and bokeh 3.9.2; pyproject.toml keeps out the next minor releases. Each
docstring names the issue, or contains the text of one that is not filed yet. Each has a test in
tests/dashboard/test_library_workarounds.py, `keep_colours` in tests/browser/test_accessibility.py, which fails once a
release no longer needs it. The browser's half is assets/scripts/repairs.js.
"""

import asyncio
import contextlib
import gc
from collections.abc import Callable, Iterator
from typing import Any
from weakref import WeakKeyDictionary

import panel as pn
import panel_material_ui as pmui
from bokeh.document import Document
from bokeh.embed.util import standalone_docs_json_and_render_items
from bokeh.model import Model
from bokeh.models import InlineStyleSheet
from bokeh.protocol.message import Message
from bokeh.server.connection import ServerConnection
from bokeh.util.token import generate_jwt_token, generate_session_id, get_session_id, get_token_payload
from panel.io import document as messages
from panel.io.document import _cleanup_doc
from panel.io.resources import LOCAL_DIST, Resources
from panel.io.server import DocHandler, Server, WSHandler, server_html_page_for_session
from panel.io.session import generate_session
from panel.io.state import set_curdoc
from panel.viewable import Viewable
from tornado.httputil import HTTPServerRequest
from tornado.routing import Rule
from tornado.web import Application, RequestHandler

SHEETS: WeakKeyDictionary[Document, dict[str, InlineStyleSheet]] = WeakKeyDictionary()
"""The style sheets of each document by their texts."""


# ---- panel-material-ui 0.16.6: the page


@contextlib.contextmanager
def leave_busy() -> Iterator[None]:
    """Stop a page that is made within from following whether anything in the process is busy.

    panel-material-ui, as issue 2626 of panel: `pmui.Page` binds `busy` to `pn.state.param.busy` and never unbinds it.
    So every closed page stays alive, and each event costs time in all open pages.
    """
    before = busy_watchers()
    yield
    for watcher in busy_watchers():
        if watcher not in before:
            pn.state.param.unwatch(watcher)


def busy_watchers() -> list[Any]:
    """Return the watchers of whether the process is busy."""
    return list(pn.state.param.watchers.get("busy", {}).get("value", []))


def keep_colours(root: Model, kinds: list[str]) -> None:
    """Stop a page from changing the colours of these kinds of Bokeh models.

    To be filed with panel-material-ui: "`Page` applies its theme to every Bokeh figure on each change of a figure, and
    overwrites colours that were set explicitly; there is no public option to exclude figures." Its script finds the
    page by the name of its class, which a subclass must keep.
    """
    root.data._custom_theme = kinds


def name_sheets(document: Document) -> None:
    """Set the address of Panel's style sheets for a document.

    As issues 5167 and 7073 of panel (requests to the CDN from a server without a network): Panel sets `dist_url` only
    when it renders the page. A session that begins with the websocket gets the address of the CDN.
    """
    if "dist_url" not in document.template_variables:
        above = pn.state.rel_path
        document.template_variables["dist_url"] = f"{above}/{LOCAL_DIST}" if above else LOCAL_DIST


class SmallFile(pmui.FileInput):
    """A file input that calls back when the browser has refused a file for its size.

    To be filed with panel-material-ui: "`FileInput` drops the `error` status of an upload that exceeds `max_file_size`;
    Python code cannot show a message."

    Parameters
    ----------
    refuse : callable
    """

    def __init__(self, refuse: Callable[[], None], **params: Any) -> None:
        super().__init__(**params)
        self._refuse = refuse

    def _handle_msg(self, msg: dict[str, Any]) -> None:
        if msg.get("status") == "error":
            self._refuse()
        else:
            super()._handle_msg(msg)


# ---- panel 1.9.4: components and panes


class HtmlPane(pn.pane.HTML):
    """HTML that is shown as it is, also where its type is `markupsafe.Markup`; panes share their style sheets.

    To be filed with panel: "`pn.pane.HTML(Markup('<b>1 &lt; 2</b>'))` shows tags: `html.escape` calls `replace`, which
    `Markup` overrides to escape its arguments." And: "A style sheet that is given as a string is sent again with each
    component: 40 panes with the same 12 kB make 480 kB, and `stylesheets` takes no models of Bokeh." And:
    "`HTML._update` builds all properties for `model.document`, which is None while the document is frozen: the
    addresses of Panel's own style sheets become those of the CDN."
    """

    def _transform_object(self, obj: Any) -> dict[str, Any]:
        transformed: dict[str, Any] = super()._transform_object(str(obj) if obj else "")
        return transformed

    def _update(self, ref: str, model: Model) -> None:
        model.text = self._transform_object(self.object)["object"]

    def _get_properties(self, doc: Document | None) -> dict[str, Any]:
        properties: dict[str, Any] = super()._get_properties(doc)
        if doc is not None and "stylesheets" in properties:
            known = SHEETS.setdefault(session_document(doc), {})
            properties["stylesheets"] = [
                known.setdefault(sheet, InlineStyleSheet(css=sheet)) if isinstance(sheet, str) else sheet
                for sheet in properties["stylesheets"]
            ]
        return properties


FAILED = "The server could not take a change; its log describes the error."


def session_document(document: Any) -> Any:
    """Return the document of a session, also in a callback without a lock.

    To be filed with bokeh: "`UnlockedDocumentProxy` is neither equal to its document nor found as a key in its place."
    """
    return getattr(document, "_doc", document)


# ---- bokeh 3.9.2: a document


def frozen(document: Any) -> int:
    """Return how many times a document is frozen."""
    return 0 if document is None else int(document.models._freeze_count)


def thaw(document: Any, count: int) -> None:
    """Thaw a document until it is frozen only so many times.

    To be filed with bokeh: "`DocumentModelManager.freeze` has no `try`/`finally`: after an exception within, the
    document stays frozen, and models that are added later are never sent."
    """
    while frozen(document) > count:
        document.models._pop_freeze()


# ---- panel 1.9.4 and bokeh 3.9.2: how a page opens. Issue 3105 of panel: the server makes a whole session for each
# request of the page, also for one whose browser never connects, and answers nobody else. Here the first
# answer is the same for all, and the session is made for the connection, one at a time: see server/opening.py.


def find_application(server: Server) -> Application:
    """Return the application of tornado that answers a server's requests, for which Bokeh has no public name."""
    application: Application = server._tornado
    return application


PageAnswer, PageConnection = DocHandler, WSHandler
"""The handlers of requests for a page and of its connection; Panel changes those of Bokeh."""


def first_html(server: Server, page: Viewable, token: str) -> str:
    """Return the first answer for any page with the same roots as this one."""
    session = generate_session(server_context(server).application, initialize=False)
    document = session.document
    try:
        with set_curdoc(document):
            page.server_doc(document, location=True)
            # as `DocHandler` does with the page that it has made for each browser
            return str(
                server_html_page_for_session(
                    session,
                    resources=Resources.from_bokeh(find_application(server).resources()),
                    title=document.title,
                    token=token,
                    template=document.template,
                    template_variables=document.template_variables,
                )
            )
    finally:
        _cleanup_doc(document, destroy=True)


def server_context(server: Server) -> Any:
    """Return the context of the pages of a server that has one."""
    (context,) = find_application(server).applications.values()
    return context


def exchange(server: Server, handlers: dict[type[RequestHandler], tuple[type[RequestHandler], dict[str, Any]]]) -> None:
    """Let others answer for handlers of the libraries and for those that inherit from them.

    Parameters
    ----------
    server : Server
    handlers : dict
        By the library's class, the class that is put before it, and its further arguments.
    """
    for rule in find_application(server).wildcard_router.rules:
        if not isinstance(rule.target, type):
            continue
        for known, (own, more) in handlers.items():
            if issubclass(rule.target, known):
                _answer_with(rule, own, more)


def _answer_with(rule: Rule, own: type[RequestHandler], more: dict[str, Any]) -> None:
    """Put a class before that which answers for a rule."""
    rule.target = own if issubclass(own, rule.target) else type(own.__name__, (own, rule.target), {})
    rule.target_kwargs = {**(rule.target_kwargs or {}), **more}


def make_token(handler: DocHandler) -> str:
    """Return a token for a new page, which holds what its browser has asked for."""
    application = handler.application
    return str(
        generate_jwt_token(
            generate_session_id(secret_key=application.secret_key, signed=application.sign_sessions),
            secret_key=application.secret_key,
            signed=application.sign_sessions,
            expiration=application.session_token_expiration,
            extra_payload={**handler._generate_token_payload(), ADDRESS: handler.request.uri},
        )
    )


ADDRESS = "railjoule_address"
"""The key of path and query of the page in a token."""


def page_of_token(token: str) -> str:
    """Return path and query of the page that a token is for."""
    return str(get_token_payload(token).get(ADDRESS, "/"))


def begin_as(request: HTTPServerRequest, address: str) -> None:
    """Let a connection look like the request for its page, from which Panel reads path and query."""
    request.uri = address
    request.path, _, request.query = address.partition("?")


def forget_begun(connection: WSHandler, token: str) -> None:
    """Forget a page that could not be made, which Bokeh would take for one that is being made."""
    connection.application_context._pending_sessions.pop(get_session_id(token), None)


def has_page(connection: WSHandler, mark: str) -> bool:
    """Return whether the page of a connection was made; where that fails, Panel puts an error in its place.

    `mark` is what the template of every page is given.
    """
    return connection.connection is not None and mark in connection.connection.session.document.template_variables


def note_pulled(connection: WSHandler, message: Message[Any]) -> None:
    """Send changes from the moment at which the browser pulls its document.

    To be filed with panel: "Changes between `PULL-DOC-REQ` and `document_ready` are neither in the pulled document nor
    sent: `state._connected` is set by the latter only."
    """
    if message.msgtype == "PULL-DOC-REQ" and connection.connection is not None:
        pn.state._connected[connection.connection.session.document] = True


def is_gone(connection: WSHandler) -> bool:
    """Return whether the browser has closed a connection."""
    return connection.ws_connection is None


def make_turns(document: Document) -> Callable[[Callable[[], None]], object]:
    """Return a function that any thread may call to run a callback in the next turn of a document.

    Issues 7219 and 7615 of bokeh: `add_next_tick_callback` is not thread-safe. While the document releases events that
    it holds, it replaces their list, and a callback that a thread adds then is lost. So the event loop adds it. To
    be called in the loop; without one, the callback is added directly.
    """
    # a document that is destroyed no longer has its session
    context = document.session_context

    def ask(turn: Callable[[], None]) -> None:
        # a page may be closed before the loop gets here, and its document then takes no callbacks
        if context is None or not context.destroyed:
            document.add_next_tick_callback(turn)

    try:
        loop = asyncio.get_running_loop()
    except RuntimeError:
        return ask
    return lambda turn: loop.call_soon_threadsafe(ask, turn)


def write_all_messages() -> None:
    """Write every message without waiting for the next change of the page.

    To be filed with panel: "Messages that come while another one is written get a task of their own
    (`panel.io.document._dispatch_msgs`). It does nothing if the earlier task has removed the document from
    `_WRITE_BLOCK` before, so the last change stays unsent until the next one."
    """
    write = messages._dispatch_msgs

    async def write_waiting(document: Document) -> None:
        if document in messages._WRITE_MSGS:
            messages._WRITE_BLOCK[document] = True
        await write(document)

    messages._dispatch_msgs = write_waiting


def collect_garbage_rarely() -> None:
    """Search for garbage in all open pages rarely, as no page is answered during a search.

    A page that opens makes some 45,000 objects that stay. With Python's own thresholds two in three pages that opened
    cost a search of all that are open, 20 ms for each of them; now the search of all comes after some hundred pages. To
    be filed with panel: "Each closed session starts `gc.collect` after `GC_DEBOUNCE` (5 s), which stops a busy
    server for 20 ms per open page; the time is not configurable."
    """
    gc.set_threshold(10_000, 5, 100)
    messages.GC_DEBOUNCE = 30


def hide_tracebacks() -> None:
    """Answer a message that failed with a sentence.

    To be filed with bokeh: "`ServerConnection.error` sends the traceback, with the server's paths, to the browser;
    there is no option to disable that."
    """

    def error(self: ServerConnection, message: Message[Any], _: str) -> Message[Any]:
        answer = self.protocol.create("ERROR", message.header["msgid"], FAILED)
        answer.content["traceback"] = None
        return answer

    ServerConnection.error = error


def document_json(document: Document) -> tuple[dict[str, Any], Any]:
    """Return a document as plain values, and where its roots go in a page without a server.

    To be filed with bokeh: "`standalone_docs_json` writes `defs` for every custom model of the process, whatever the
    document contains": 171 of 470 kB.
    """
    docs, (item,) = standalone_docs_json_and_render_items(document)
    # the library defines each component that the process has ever shown, with its texts, whatever the document holds
    used = {getattr(kind, "__qualified_model__", "") for model in document.models for kind in type(model).__mro__}
    for doc in docs.values():
        doc["defs"] = [one for one in doc.get("defs", []) if one["name"] in used]
    return docs, item
