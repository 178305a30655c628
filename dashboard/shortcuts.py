"""Shortcuts through Param, Panel and Bokeh: functions of theirs that do the same with less work as a page opens.

They take the place of the libraries' own for the whole process, which stay at hand as `replaces`, and hang on their
insides as those of insides.py do. Together they halve what opening a page takes of the processor
(`python -m tests.nightly.opening`); tests/dashboard/test_shortcuts.py holds them against what they replace.
"""

from collections.abc import Callable
from copy import copy
from typing import Any

import panel as pn
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
from bokeh.model import Model
from bokeh.model import util as searching
from panel.custom import ReactiveESM
from panel.pane.holoviews import find_links, link_axes
from panel.param import link_param_method
from panel.reactive import Syncable
from panel.viewable import Viewable
from panel_material_ui.theme import MaterialDesign
from param import parameterized
from param._utils import _is_mutable_container


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
