"""What hangs on the insides of Panel, panel-material-ui and Bokeh: on what no release of them promises to keep.

So does shortcuts.py, on those of Param as well. Tried with panel 1.9.4, panel-material-ui 0.16.6, bokeh 3.9.2 and param
2.4.2; pyproject.toml keeps out the next minor releases, and
tests/dashboard/test_insides.py reads the installed ones and says, without a browser, where they read otherwise. The
browser's half is assets/scripts/follow.js and assets/scripts/mends.js.
"""

import asyncio
import gc
from collections.abc import Callable
from typing import Any
from weakref import WeakKeyDictionary

import panel as pn
import panel_material_ui as pmui
import param
from bokeh.document import Document
from bokeh.embed.util import standalone_docs_json_and_render_items
from bokeh.model import Model
from bokeh.models import InlineStyleSheet
from bokeh.protocol.message import Message
from bokeh.server.connection import ServerConnection
from bokeh.util.token import generate_jwt_token, generate_session_id, get_session_id, get_token_payload
from panel.custom import JSComponent
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
"""Style sheets of each document: there are hundreds of panes, and it is sent each sheet once."""


# ---- panel-material-ui 0.16.6: the page


def leave_busy(page: pmui.Page) -> None:
    """Let a page no longer listen to whether anything in the process is busy.

    It never stops by itself, so that every closed page stays alive and every change anywhere costs all open pages: see
    issue 2626 of panel. `page.busy = False` ends the cost, but not the leak.
    """
    private = page._param__private
    for _, watcher in list(private.ref_watchers):
        pn.state.param.unwatch(watcher)
    private.ref_watchers.clear()
    private.refs.pop("busy", None)


def keep_colours(root: Model, kinds: list[str]) -> None:
    """Let a page not dress these kinds of Bokeh models; in the browser, it would dress all figures anew.

    The browser's half looks for a class called Page: who inherits from the library's page keeps the name.
    """
    root.data._custom_theme = kinds


def name_sheets(document: Document) -> None:
    """Tell a document where Panel's style sheets are.

    Panel 1.9.4 does that when it renders the page, and a session may begin without that, where the browser comes so
    late that the first one is gone: then it would ask another host for them.
    """
    if "dist_url" not in document.template_variables:
        above = pn.state.rel_path
        document.template_variables["dist_url"] = f"{above}/{LOCAL_DIST}" if above else LOCAL_DIST


class SmallFile(pmui.FileInput):
    """A file to open; one that is too large is not even sent, and the widget alone is told so.

    Parameters
    ----------
    refuse : callable
        Called when the browser has refused a file for its size.
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


def count_no_events() -> None:
    """Let Panel no longer count the events that it is busy with.

    It opens and closes all parameters of its state eight times for each event, a tenth of what a move of a slider
    costs, for an indicator that no page of ours has.
    """
    pn.state._add_busy_event = pn.state._remove_busy_event = lambda _: None


def share_sheets(doc: Document | None, properties: dict[str, Any]) -> dict[str, Any]:
    """Return the properties of a model with style sheets that other models of the document have too."""
    if doc is not None and "stylesheets" in properties:
        known = SHEETS.setdefault(doc, {})
        properties["stylesheets"] = [
            known.setdefault(sheet, InlineStyleSheet(css=sheet)) if isinstance(sheet, str) else sheet
            for sheet in properties["stylesheets"]
        ]
    return properties


class LightComponent(JSComponent):
    """A component of which a page has many: it shares its style sheets, and what the browser tells is taken at once.

    The library waits 50 ms for more to come. A script that sends no more often than that needs no such wait; where the
    server is busy, it still takes the last of several values alone, as it reads all that has come before it acts.
    """

    _debounce = 5
    # the script is in `_esm`; the library would look on the disk for a bundle of it each time
    _bundle_path = None

    def _get_properties(self, doc: Document | None) -> dict[str, Any]:
        return share_sheets(doc, super()._get_properties(doc))


FAILED = "The server could not take a change; its log describes the error."
AS_TEXT = "<plaintext>"
"""All that follows this element is text to a browser. Panel's half reads what it is sent as HTML, and takes the text of
that for the HTML to show; Panel escapes each letter of it, which takes up to six letters for one."""


class Words(pn.pane.HTML):
    """HTML that changes often: only the new text goes to the browser.

    The library would send every property of the pane anew, with a style sheet of its own for each.
    """

    # the library would make a row for each pane, in case it is shown by itself; ours all stand in columns
    default_layout = param.Parameter(default=lambda *_, **__: None)

    def _sync_layoutable(self, *_: Any) -> None:
        """Tell nobody of sizes, as there is no row."""

    def _get_properties(self, doc: Document | None) -> dict[str, Any]:
        return share_sheets(doc, super()._get_properties(doc))

    def _transform_object(self, obj: Any) -> dict[str, Any]:
        return {"object": AS_TEXT + str(obj) if obj else ""}

    def _update(self, ref: str, model: Model) -> None:
        model.text = self._transform_object(self.object)["object"]


def models_of(view: Viewable) -> list[Model]:
    """Return the models that draw a part of the page."""
    return [model for model, _ in view._models.values()]


def session_document(document: Any) -> Any:
    """Return the document of a session; in a callback, what Bokeh 3.9.2 hands out may only stand for it."""
    return getattr(document, "_doc", document)


# ---- bokeh 3.9.2: a document searches all that it holds whenever that changes, unless it is frozen


def freeze(document: Document) -> None:
    """Let a document not be searched for new models until it is thawed."""
    document.models._push_freeze()


def thaw(document: Any, count: int) -> None:
    """Thaw a document until it is frozen only so many times; it is searched when it is no longer frozen."""
    while frozen(document) > count:
        document.models._pop_freeze()


def thaw_unsearched(document: Document) -> None:
    """Thaw a document once and do not search it; what has left the page stays known until the next search."""
    document.models._freeze_count -= 1


def frozen(document: Any) -> int:
    """Return how many times a document is frozen."""
    return 0 if document is None else int(document.models._freeze_count)


def attach(document: Any, model: Model) -> None:
    """Make a model and all that it holds models of a document, as a search of the whole document would."""
    models = document.models
    for new in model.references():
        if new.id not in models:
            new._attach_document(document)
            models[new.id] = new
            models._new_models.add(new)
            if new.name is not None:
                models._models_by_name.add_value(new.name, new)


def application_of(server: Server) -> Application:
    """Return the application of tornado that answers a server's requests, for which Bokeh has no public name."""
    application: Application = server._tornado
    return application


# ---- panel 1.9.4 and bokeh 3.9.2: how a page opens

PageAnswer, PageConnection = DocHandler, WSHandler
"""What answers whoever asks for a page, and what its browser then connects to; Panel changes those of Bokeh."""


def first_html(server: Server, page: Viewable, token: str) -> str:
    """Return what a browser gets first of any page with the same roots as this one, made for nobody."""
    session = generate_session(server_context(server).application, initialize=False)
    document = session.document
    try:
        with set_curdoc(document):
            page.server_doc(document, location=True)
            # as `DocHandler` does with the page that it has made for each browser
            return str(
                server_html_page_for_session(
                    session,
                    resources=Resources.from_bokeh(application_of(server).resources()),
                    title=document.title,
                    token=token,
                    template=document.template,
                    template_variables=document.template_variables,
                )
            )
    finally:
        _cleanup_doc(document, destroy=True)


def server_context(server: Server) -> Any:
    """Return what holds the pages of a server that has one."""
    (context,) = application_of(server).applications.values()
    return context


def exchange(server: Server, handlers: dict[type[RequestHandler], tuple[type[RequestHandler], dict[str, Any]]]) -> None:
    """Let others answer for handlers of the libraries and for those that inherit from them.

    Parameters
    ----------
    server : Server
    handlers : dict
        By the library's class, ours, which is put before it, and what more it is given.
    """
    for rule in application_of(server).wildcard_router.rules:
        if not isinstance(rule.target, type):
            continue
        for known, (own, more) in handlers.items():
            if issubclass(rule.target, known):
                _answer_with(rule, own, more)


def _answer_with(rule: Rule, own: type[RequestHandler], more: dict[str, Any]) -> None:
    """Put a class before that which answers for a rule."""
    rule.target = own if issubclass(own, rule.target) else type(own.__name__, (own, rule.target), {})
    rule.target_kwargs = {**(rule.target_kwargs or {}), **more}


def token_of(handler: DocHandler) -> str:
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
"""What a token calls the path and the query of its page."""


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
    """Let a page that has just been written down for its browser be sent what is changed in it from then on.

    Panel 1.9.4 begins when the browser says that the page is drawn. It takes for granted that what was changed before
    is written down with the page, which the browser asks for later than that; here it asks at once.
    """
    if message.msgtype == "PULL-DOC-REQ" and connection.connection is not None:
        pn.state._connected[connection.connection.session.document] = True


def is_gone(connection: WSHandler) -> bool:
    """Return whether the browser has closed a connection."""
    return connection.ws_connection is None


def turns_of(document: Document) -> Callable[[Callable[[], None]], object]:
    """Return what lets a document take a turn of its own, and may be called in any thread.

    A turn that a thread asks of a document itself is lost where that is just giving free the changes that it holds:
    they are copied, then their list is replaced, and Bokeh notes turns in that list too. So the event loop asks for it,
    between its own turns. To be called in the loop; without one, the document is asked directly.
    """

    def ask(turn: Callable[[], None]) -> None:
        # a page may be closed before the loop gets here, and its document then takes no callbacks
        context = document.session_context
        if context is None or not context.destroyed:
            document.add_next_tick_callback(turn)

    try:
        loop = asyncio.get_running_loop()
    except RuntimeError:
        return ask
    return lambda turn: loop.call_soon_threadsafe(ask, turn)


def write_all_messages() -> None:
    """Let no message wait for the page's next change.

    Panel 1.9.4 writes what came while another message was on its way in a task of its own, which does nothing if the
    task before it has marked the page as free meanwhile: the page then showed the last result only at the next move.
    """
    write = messages._dispatch_msgs

    async def write_waiting(document: Document) -> None:
        if document in messages._WRITE_MSGS:
            messages._WRITE_BLOCK[document] = True
        await write(document)

    messages._dispatch_msgs = write_waiting


def collect_garbage_seldom() -> None:
    """Let Python look for garbage in all open pages seldom: meanwhile no page is answered.

    A page that opens makes some 45,000 objects that stay. With Python's own thresholds two in three pages that opened
    cost a search of all that are open, 20 ms for each of them; now the search of all comes after some hundred pages.
    Panel collects too, some seconds after each page that was closed: what that frees is wanted back, but not at once.
    """
    gc.set_threshold(10_000, 5, 100)
    messages.GC_DEBOUNCE = 30


def tell_no_insides() -> None:
    """Let what answers a message that failed be a sentence: Bokeh 3.9.2 sends the traceback, with paths."""

    def error(self: ServerConnection, message: Message[Any], _: str) -> Message[Any]:
        answer = self.protocol.create("ERROR", message.header["msgid"], FAILED)
        answer.content["traceback"] = None
        return answer

    ServerConnection.error = error


def written_down(document: Document) -> tuple[dict[str, Any], Any]:
    """Return a document as plain values, and where its roots go in a page without a server."""
    docs, (item,) = standalone_docs_json_and_render_items(document)
    # the library defines each component that the process has ever shown, with its texts, whatever the document holds
    used = {getattr(kind, "__qualified_model__", "") for model in document.models for kind in type(model).__mro__}
    for doc in docs.values():
        doc["defs"] = [one for one in doc.get("defs", []) if one["name"] in used]
    return docs, item
