"""What hangs on the insides of Panel, panel-material-ui and Bokeh: on what no release of them promises to keep.

Tried with panel 1.9.4, panel-material-ui 0.16.6 and bokeh 3.9.2; pyproject.toml keeps out the next minor releases, and
tests/dashboard/test_insides.py reads the installed ones and says, without a browser, where they read otherwise. The
browser's half is assets/scripts/follow.js and assets/scripts/mends.js.
"""

import asyncio
import gc
import socket
from collections.abc import Callable
from copy import copy
from typing import Any
from weakref import WeakKeyDictionary

import panel as pn
import panel_material_ui as pmui
import param
from bokeh.core.has_props import HasProps, MetaHasProps, is_DataModel
from bokeh.core.property.bases import ParameterizedProperty, Property
from bokeh.core.property.descriptors import AliasPropertyDescriptor, PropertyDescriptor
from bokeh.core.property.singletons import Intrinsic, Undefined
from bokeh.core.property.wrappers import (
    PropertyValueContainer,
    PropertyValueDict,
    PropertyValueList,
    PropertyValueSet,
)
from bokeh.core.serialization import Ref, Serializer
from bokeh.document import Document
from bokeh.embed.util import standalone_docs_json_and_render_items
from bokeh.model import Model
from bokeh.model import util as searching
from bokeh.models import InlineStyleSheet
from bokeh.protocol.message import Message
from bokeh.server.connection import ServerConnection
from bokeh.util.token import generate_jwt_token, generate_session_id, get_session_id, get_token_payload
from panel.custom import JSComponent, ReactiveESM
from panel.io import document as messages
from panel.io.document import _cleanup_doc
from panel.io.resources import LOCAL_DIST, Resources
from panel.io.server import DocHandler, Server, WSHandler, server_html_page_for_session
from panel.io.session import generate_session
from panel.io.state import set_curdoc
from panel.pane.holoviews import find_links, link_axes
from panel.param import link_param_method
from panel.reactive import Syncable
from panel.viewable import Viewable
from panel_material_ui.theme import MaterialDesign
from param import parameterized
from param._utils import _is_mutable_container
from tornado.httputil import HTTPServerRequest
from tornado.iostream import IOStream
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


def make_views_lightly() -> None:
    """Let Panel look up once what it asks each of the hundreds of parts of a page again and again.

    Its answers are the same for all parts of a class, or for all pages of a server.
    """
    # each goes through all parts of the page, six times as it opens, for methods and panes of HoloViews: ours has none
    for hook in (link_param_method, link_axes, find_links):
        if hook in Viewable._preprocessing_hooks:
            Viewable._preprocessing_hooks.remove(hook)
    Syncable._init_params = _init_params
    parameterized._instantiate_param_obj = _own_parameter
    parameterized._instantiated_parameter = _parameter_of(parameterized._instantiated_parameter)
    for name in ("_get_properties", "_get_children"):
        setattr(ReactiveESM, name, _reading_of(getattr(ReactiveESM, name)))
    MaterialDesign._get_modifiers = classmethod(_modifiers_of(MaterialDesign._get_modifiers.__func__))
    ReactiveESM._component_resource_path = classmethod(_resource_path_of(ReactiveESM._component_resource_path.__func__))


def _init_params(self: Any) -> dict[str, Any]:
    """Return what is set of what the browser shares; the library lists all that is shared for each name anew."""
    values = ((name, getattr(self, name)) for name in self._synced_params)
    return {name: value for name, value in values if value is not None}


def _own_parameter(parameter: Any, owner: Any = None) -> Any:
    """Return a copy of a parameter for one object.

    A page has 2000 of them. The library copies each through functions for whoever watches a parameter, which nobody
    does with a new one, and asks three abstract classes for each value whether it can be changed.
    """
    kind: Any = type(parameter)
    made = kind.__new__(kind)
    for slot in kind._all_slots_:
        value = object.__getattribute__(parameter, slot)
        if slot != "default" and _can_change(type(value), value):
            value = copy(value)
        object.__setattr__(made, slot, value)
    object.__setattr__(made, "owner", owner)
    object.__setattr__(made, "watchers", {})
    return made


READ: set[int] = set()
"""Parts of pages that are just written down for the browser, by their `id`."""


def _parameter_of(look_up: Any) -> Any:
    def parameter_of(part: Any, parameter: Any) -> Any:
        # three in four of a page's parameters were copied for a look at their kind
        if id(part) in READ:
            return part._param__private.params.get(parameter.name, parameter)
        return look_up(part, parameter)

    parameter_of.replaces = look_up  # type: ignore[attr-defined]
    return parameter_of


def _reading_of(read: Any) -> Any:
    def reading(self: Any, *args: Any) -> Any:
        within = id(self) in READ
        READ.add(id(self))
        try:
            return read(self, *args)
        finally:
            if not within:
                READ.discard(id(self))

    reading.replaces = read  # type: ignore[attr-defined]
    return reading


def _modifiers_of(look_up: Any) -> Any:
    known: dict[tuple[Any, ...], tuple[dict[str, Any], dict[str, Any]]] = {}

    def modifiers_of(
        cls: Any, viewable: Any, theme: Any, isolated: Any = None
    ) -> tuple[dict[str, Any], dict[str, Any]]:
        document = pn.state.curdoc
        served = document is not None and bool(document.session_context)
        key = cls, type(viewable), type(theme), isolated, served, pn.state.rel_path
        if key not in known:
            known[key] = look_up(cls, viewable, theme, isolated)
        modifiers, of_children = known[key]
        # what asks puts the document's own style sheets into it
        return dict(modifiers), of_children

    modifiers_of.replaces = look_up  # type: ignore[attr-defined]
    return modifiers_of


CHANGING: dict[type, bool] = {}


def _can_change(kind: type, value: Any) -> bool:
    known = CHANGING.get(kind)
    return CHANGING.setdefault(kind, _is_mutable_container(value)) if known is None else known


def _resource_path_of(look_up: Any) -> Any:
    known: dict[tuple[Any, ...], str] = {}

    def path_of(cls: Any, path: Any, compiled: Any) -> str:
        # a page below a path asks for files below it
        key = cls, path, compiled, pn.state.rel_path
        if key not in known:
            known[key] = look_up(cls, path, compiled)
        return known[key]

    return path_of


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


PLAIN = frozenset({type(None), bool, int, float, str, type(Undefined)})
"""Kinds of values that nobody can change."""


def remember_defaults() -> None:
    """Let Bokeh look up once for each class what its properties are by default, where no function makes that.

    It collects, copies and validates the default anew for each property of each model, whenever that is made, read or
    written down: a third of what it took to open a page.
    """
    PropertyDescriptor._get_default = _default_of(PropertyDescriptor._get_default)
    PropertyDescriptor.has_unstable_default = _by_class(PropertyDescriptor.has_unstable_default)
    # by far the most models are given what another one was given: stretch_width, False, an axis of the same colour
    Property.prepare_value = _prepared_of(Property.prepare_value)
    # each dict that is validated asks for the name of its type, for an error that it hardly ever raises
    ParameterizedProperty.__str__ = _once(ParameterizedProperty.__str__)
    # asked for with each value of each model; that an attribute is not there takes Python long to find out
    HasProps.themed_values = _themed_values  # type: ignore[method-assign]


def read_set_values_alone() -> None:
    """Let Bokeh make, search and write down a model by the values that it was given.

    It goes through all 20 to 60 properties of a model each time, of which hardly any was set: for a page of 600 models
    that was a quarter of what it took to open it.
    """
    HasProps.__init__ = _made_of(HasProps.__init__)  # type: ignore[method-assign]
    HasProps.query_properties_with_values = _written_of(  # type: ignore[method-assign]
        HasProps.query_properties_with_values
    )
    searching.visit_immediate_value_references = _searched_of(searching.visit_immediate_value_references)


MOST_REMEMBERED, LONGEST_REMEMBERED = 64, 48
"""So many values of a property are remembered, and texts of so many letters: what visitors type has no end."""


def _prepared_of(prepare: Any) -> Any:
    def prepared(self: Any, owner: Any, name: str, value: Any, *, hint: Any = None) -> Any:
        kind = type(value)
        is_new = value is Undefined or (kind is str and len(value) > LONGEST_REMEMBERED)
        if kind not in PLAIN or is_new or self.assertions:
            return prepare(self, owner, name, value, hint=hint)
        # as 1 == 1.0 == True
        key, valid = (kind, value), vars(self).setdefault("_railjoule_valid", set())
        if key in valid:
            return value
        found = prepare(self, owner, name, value, hint=hint)
        # what is changed on the way is changed each time
        if found is value and len(valid) < MOST_REMEMBERED:
            valid.add(key)
        return found

    prepared.replaces = prepare  # type: ignore[attr-defined]
    return prepared


def define_once() -> None:
    """Let Bokeh write down once what kinds of components there are, which it tells each page that opens.

    There are 150 of them, whatever the page holds.
    """
    kinds = Serializer._encoders
    kinds[MetaHasProps] = _defined_of(kinds[MetaHasProps])


def _defined_of(define: Any) -> Any:
    known: dict[type, Any] = {}

    def defined(kind: Any, serializer: Serializer) -> Any:
        if kind in known:
            serializer.add_ref(kind, Ref(id=kind.__qualified_model__))
            return known[kind]
        found = define(kind, serializer)
        # one that extends another tells of that too, where it is the first to name it
        if is_DataModel(kind) and "extends" not in found and not _holds_models(found):
            known[kind] = found
        return found

    defined.replaces = define  # type: ignore[attr-defined]
    return defined


def _holds_models(value: Any) -> bool:
    """Return whether anything in a definition belongs to one page or to one message."""
    if isinstance(value, dict):
        return "id" in value or any(map(_holds_models, value.values()))
    if isinstance(value, list):
        return any(map(_holds_models, value))
    return type(value) not in PLAIN


def _themed_values(self: Any) -> Any:
    return vars(self).get("__themed_values__")


def _default_of(look_up: Callable[[Any, Any], Any]) -> Callable[[Any, Any], Any]:
    known: dict[type, dict[str, Any]] = {}
    containers: dict[type, dict[str, tuple[type, Any]]] = {}

    def default_of(self: Any, of: Any) -> Any:
        name, themed = self.name, of.themed_values()
        if themed is not None and name in themed:
            return look_up(self, of)
        kind = of.__class__
        defaults = known.setdefault(kind, {})
        if name in defaults:
            return defaults[name]
        own, contained = of._unstable_default_values, containers.setdefault(kind, {})
        if name in own:
            return own[name]
        if name in contained:
            wrapper, value = contained[name]
            own[name] = made = wrapper(value)
            made._register_owner(of, self)
            return made
        found = look_up(self, of)
        if type(found) in PLAIN:
            # an unstable one is made for each model, even where the first is a plain value
            if not self.has_unstable_default(of):
                defaults[name] = found
        elif type(found) in WRAPPED and not callable(_untouched_default(self, kind)):
            # a copy, as the first model may change its own
            contained[name] = type(found), WRAPPED[type(found)](found)
        return found

    return default_of


WRAPPED: dict[type, type] = {PropertyValueList: list, PropertyValueDict: dict, PropertyValueSet: set}
"""What Bokeh wraps so that a model hears of its changes."""


def _untouched_default(descriptor: Any, kind: Any) -> Any:
    """Return the default of a class as it was declared, or what makes it."""
    return kind._overridden_defaults().get(descriptor.name, descriptor.property._default)


class _Kind:
    """What a class of models says of the properties that its models were not given."""

    def __init__(self, kind: Any) -> None:
        self.descriptors: dict[str, Any] = {name: kind.lookup(name) for name in kind.properties(_with_props=True)}
        self.with_references = frozenset(kind.properties_with_refs())
        self.required = tuple(
            name
            for name, one in self.descriptors.items()
            if not isinstance(one, AliasPropertyDescriptor) and _untouched_default(one, kind) is Undefined
        )
        self.made_at_once = tuple(one for one in self.descriptors.values() if self._is_made_at_once(one, kind))

    @staticmethod
    def _is_made_at_once(descriptor: Any, kind: Any) -> bool:
        """Return whether a new model needs a default of its own at once.

        An empty list does not: it is written down only once it holds something, and who puts something into it asks
        for it first.
        """
        # a second name for another property
        if isinstance(descriptor, AliasPropertyDescriptor):
            return False
        overridden = kind.__overridden_defaults__.get(descriptor.name)
        if not (descriptor.property._may_have_unstable_default() or descriptor.is_unstable(overridden)):
            return False
        default = _untouched_default(descriptor, kind)
        # a list that Bokeh does not wrap is written down empty too
        return callable(default) or bool(default) or type(descriptor.property.wrap(copy(default))) not in WRAPPED


_KINDS: dict[type, _Kind] = {}


def _kind(model: Any) -> _Kind:
    kind = type(model)
    return _KINDS.get(kind) or _KINDS.setdefault(kind, _Kind(kind))


def _made_of(make: Any) -> Any:
    def made(self: Any, **properties: Any) -> None:
        super(HasProps, self).__init__()
        self._property_values, self._unstable_default_values, self._unstable_themed_values = {}, {}, {}
        for name, value in properties.items():
            if value is not Undefined and value is not Intrinsic:
                setattr(self, name, value)
        for descriptor in _kind(self).made_at_once:
            if descriptor.name not in properties:
                descriptor._get(self)
        self._initialized = True

    made.replaces = make  # type: ignore[attr-defined]
    return made


def _written_of(write: Any) -> Any:
    def written(
        self: Any, query: Callable[[Any], bool], *, include_defaults: bool = True, include_undefined: bool = False
    ) -> dict[str, Any]:
        kind, given, own = _kind(self), self._property_values, self._unstable_default_values
        whole = include_defaults or include_undefined or self.themed_values() is not None
        # the library says best what is missing
        if whole or not all(name in given for name in kind.required):
            found: dict[str, Any] = write(
                self, query, include_defaults=include_defaults, include_undefined=include_undefined
            )
            return found
        found = {}
        for name, descriptor in kind.descriptors.items():
            if (name in given or name in own) and query(descriptor):
                value = descriptor.get_value(self)
                # one that was changed stands among those that were given
                if not (isinstance(value, PropertyValueContainer) and name in own):
                    found[name] = value
        return found

    written.replaces = write  # type: ignore[attr-defined]
    return written


def _searched_of(search: Any) -> Any:
    def searched(value: Any, visitor: Callable[[Model], None]) -> None:
        if not isinstance(value, HasProps) or value.themed_values() is not None:
            search(value, visitor)
            return
        names = _kind(value).with_references
        for values in (value._property_values, value._unstable_default_values):
            for name, held in values.items():
                if name in names and type(held) not in PLAIN:
                    searching.visit_value_and_its_immediate_references(held, visitor)

    searched.replaces = search  # type: ignore[attr-defined]
    return searched


def _once(name_of: Callable[[Any], str]) -> Callable[[Any], str]:
    def named(self: Any) -> str:
        name: str | None = vars(self).get("_railjoule_name")
        if name is None:
            name = vars(self)["_railjoule_name"] = name_of(self)
        return name

    return named


def _by_class(look_up: Callable[[Any, Any], bool]) -> Callable[[Any, Any], bool]:
    known: dict[type, dict[str, bool]] = {}

    def found_for(self: Any, of: Any) -> bool:
        answers = known.setdefault(of.__class__, {})
        if self.name not in answers:
            answers[self.name] = look_up(self, of)
        return answers[self.name]

    return found_for


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


def listen_no_more(server: Server) -> None:
    """Let a server listen nowhere; it goes on with the connections that it has and with those that it is given."""
    server._http.stop()


def taking(server: Server) -> Callable[[socket.socket], None]:
    """Return what lets a server serve a connection that was taken elsewhere."""

    def take(connection: socket.socket) -> None:
        address = connection.getpeername()
        stream = IOStream(connection, max_buffer_size=server._http.max_buffer_size)
        server._http.handle_stream(stream, address)

    return take


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
    ask: Callable[[Callable[[], None]], object] = document.add_next_tick_callback
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
