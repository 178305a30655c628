"""A page's state in its address: short, readable, versioned, and checked value by value when it is read."""

import base64
import binascii
import json
import zlib
from collections.abc import Container, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any
from urllib.parse import parse_qsl, quote_plus

import param

from railjoule.core import RailjouleError
from railjoule.core.budget import PAGE
from railjoule.dashboard.keep.snapshot import Snapshot, changed, fields_of
from railjoule.dashboard.limits import DEEPEST, LONGEST_LINK, LONGEST_TEXT, MAX_FIELDS, MOST_KEYS
from railjoule.dashboard.state.kept import Kept, short
from railjoule.dashboard.workbench import Workbench

FORMER_KEYS: Mapping[str, str] = {
    "robustness.accepted_delay_s": "what_if.accepted_lateness_s",
    "robustness.knows": "what_if.known",
    "wide_map": "trade_off.wide_map",
    "copper_weight": "trade_off.copper_weight",
    "compare_all": "compare.compare_all",
    "reference": "compare.reference",
}
"""By earlier key the present one, where the field has another name."""
FORMER_MODELS: Mapping[str, tuple[str, ...]] = {
    "robustness": ("day", "what_if"),
    "disturbances": ("day",),
    "actual": ("day",),
    "measured_runs": ("files",),
    "study": ("explore",),
    "speed_limits": ("set_speeds",),
}
"""By earlier model the present ones, which have its fields under the same names."""
FORMER_PAGES: Mapping[str, Mapping[str, str]] = {
    "Robustness": {"page": "What if", "what_if.tab": "load"},
    "Disturbances": {"page": "What if", "what_if.tab": "events"},
    "Import": {"page": "Files", "files.tab": "line"},
    "Measured runs": {"page": "Files", "files.tab": "runs"},
    "Study": {"page": "Explore"},
    "Speed limits": {"page": "Set speeds"},
}
"""By earlier page the values that open its successor."""


def present_key(key: str, fields: Container[str]) -> str:
    """Return the present key of a key in an address; the same one if it is not an earlier key.

    Parameters
    ----------
    key : str
    fields : container of str
        All present keys.
    """
    if key in FORMER_KEYS:
        return FORMER_KEYS[key]
    model, _, field = key.partition(".")
    present = (f"{successor}.{field}" for successor in FORMER_MODELS.get(model, ()))
    return next((one for one in present if one in fields), key)


VERSION = "1"
LONGEST_QUERY = 1_500
"""Up to this length a state stands in the query, which is sent to the server; a longer one stands behind `#`."""
# a shorter one stays readable, and can be changed by hand in the address
LONGEST_PLAIN = 200
"""A longer text is packed."""
# values that a sentence lists where they cannot be opened
MAX_LISTED = 3
PACKED, NOTHING, EMPTY = "~", "none", "[]"


class LinkTooLongError(RailjouleError):
    """A state that no address can hold, in one sentence."""


@dataclass(frozen=True)
class ReadLink:
    """Content of a link, and one sentence on the parts that cannot be opened."""

    snapshot: Snapshot = field(default_factory=dict)
    refusal: str = ""


def write_link(snapshot: Mapping[str, Any], originals: Mapping[str, Any]) -> str:
    """Return the end of an address that opens a snapshot: nothing, `?v=1&...` or `#v=1&...`.

    Parameters
    ----------
    snapshot : mapping
        All that is kept of a page.
    originals : mapping
        The same of a new page with the same scenario and edits.

    Raises
    ------
    LinkTooLongError
        If it takes more characters than an address may have.
    """
    first = _template().keep() | _template().scenario.keep()
    # the scenario and its edits are named against those of a new page, all else against the scenario
    before = {**originals, **{key: first[key] for key in ("preset", "toml", "edits")}}
    differs = changed(snapshot, before)
    # the file's text is the whole scenario: the preset is the one that was chosen before it
    if differs.get("toml") is not None:
        differs.pop("preset", None)
    if not differs:
        return ""
    # commas and colons may stand in an address as they are: lists stay readable
    parts = [f"{quote_plus(key)}={quote_plus(_text(value), safe=',:')}" for key, value in differs.items()]
    text = "&".join([f"v={VERSION}", *parts])
    if len(text) > LONGEST_LINK:
        raise LinkTooLongError(
            f"The page's state takes {len(text):,} characters; an address holds at most {LONGEST_LINK:,}. "
            "Save it as TOML, because a reload will lose it."
        )
    return f"{'?' if len(text) <= LONGEST_QUERY else '#'}{text}"


# not by Panel's `location.sync`, which checks nothing: a number of 400 digits broke the page by an OverflowError
def read_link(query: str) -> ReadLink:
    """Return the snapshot that a query or a fragment holds; every value in it is of its kind and in its bounds.

    It never fails: unreadable values are left out, and reported in one sentence. All of its values together have
    as many characters as one text may have.
    """
    text = query.lstrip("?#")
    if len(text) > LONGEST_LINK:
        return ReadLink(refusal=f"The link is longer than the limit of {LONGEST_LINK:,} characters; it was not opened.")
    try:
        # what is no UTF-8 is replaced, and its value refused; strictly it would raise ValueError, as too many values do
        pairs = dict(parse_qsl(text, keep_blank_values=True, max_num_fields=MAX_FIELDS, errors="replace"))
    except ValueError:
        return ReadLink(refusal=f"The link has more than the limit of {MAX_FIELDS} values; it was not opened.")
    known = {key: (model, name) for key, model, name in fields_of(_template())}
    pairs |= FORMER_PAGES.get(pairs.get("page", ""), {})
    version = pairs.pop("v", None)
    if version is None:
        # an address without a version may carry anybody's values
        pairs = {key: value for key, value in pairs.items() if present_key(key, known) in known}
    elif version != VERSION:
        shown = short(version)
        sentence_of_version = f"The link has version {shown}, but this page reads version {VERSION}; it was not opened."
        return ReadLink(refusal=sentence_of_version)
    snapshot: Snapshot = {}
    refusals: list[str] = []
    left = LONGEST_TEXT
    # where a link names both keys of a field, the present one counts: it comes last
    for key, value in sorted(pairs.items(), key=lambda pair: pair[0] in known):
        field = present_key(key, known)
        if field not in known:
            refusals.append(f"{short(key)} is not known")
            continue
        try:
            value = _unpacked(value, left)  # noqa: PLW2901
            left -= len(value)
            snapshot[field] = _value(*known[field], value)
        except ValueError as refusal:
            refusals.append(f"{key} = {short(value)} {refusal}")
    return ReadLink(snapshot, sentence(refusals))


def sentence(refusals: list[str]) -> str:
    """Return one sentence on what of a link was left out."""
    if not refusals:
        return ""
    more = f" (and {len(refusals) - MAX_LISTED} more)" if len(refusals) > MAX_LISTED else ""
    shown = "; ".join(refusals[:MAX_LISTED])
    return f"Parts of the link were ignored: {shown}{more}{'' if shown.endswith('?') and not more else '.'}"


@lru_cache(maxsize=1)
def _template() -> Workbench:
    """Return a new page's state, which nobody changes."""
    return Workbench()


def _text(value: Any) -> str:
    """Return a value as a link names it."""
    if value is None:
        return NOTHING
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        # so that 2.0 reads 2; below 1e15, a float is surely the whole number that it reads as
        return repr(int(value)) if value == int(value) and abs(value) < 1e15 else repr(value)
    if isinstance(value, list) and all(isinstance(item, str) for item in value):
        text = ",".join(value) or EMPTY
    else:
        text = value if isinstance(value, str) else json.dumps(value, separators=(",", ":"), ensure_ascii=False)
    return _packed(text) if len(text) > LONGEST_PLAIN else text


@lru_cache(maxsize=4)
def _packed(text: str) -> str:
    """Return a text packed; kept, as a long one takes a tenth of a second and is written at every change."""
    # padding left out, as an address would have three signs for each `=`; `_unpacked` restores it
    return PACKED + base64.urlsafe_b64encode(zlib.compress(text.encode(), 9)).decode().rstrip("=")


def _unpacked(text: str, longest: int) -> str:
    """Return a text unpacked if it is packed; raises ValueError where it is longer than allowed."""
    if not text.startswith(PACKED):
        return text
    packed = text.removeprefix(PACKED)
    try:
        raw = base64.urlsafe_b64decode(packed + "=" * (-len(packed) % 4))
        unpacker = zlib.decompressobj()
        # no more is unpacked than is allowed, as some bytes may stand for gigabytes; to zlib, 0 is no limit
        content = unpacker.decompress(raw, max(longest, 1))
        if unpacker.unconsumed_tail or not unpacker.eof:
            raise ValueError("is too long or incomplete")
        return content.decode()
    except (binascii.Error, zlib.error, UnicodeError):
        raise ValueError("is damaged") from None


def _value(model: Kept, name: str, text: str) -> Any:
    """Return the checked value that a link's text gives for a field.

    Raises
    ------
    ValueError
        With the end of a sentence that begins with field and text.
    """
    parameter = model.param[name]
    if text == NOTHING and parameter.allow_None:
        return None
    if isinstance(parameter, param.Boolean):
        return model.checked(name, {"true": True, "false": False}.get(text, text))
    if isinstance(parameter, param.Number):
        return model.checked(name, _number(text))
    if isinstance(parameter, param.ListSelector):
        return model.checked(name, [] if text == EMPTY else text.split(","))
    if isinstance(parameter, param.Selector):
        return model.checked(name, {_text(one): one for one in parameter.objects}.get(text, text))
    if isinstance(parameter, param.String):
        return model.checked(name, text)
    return model.checked(name, _from_json(text))


def _number(text: str) -> float:
    try:
        number = float(text)
    except ValueError:
        raise ValueError("must be a number") from None
    return int(number) if abs(number) < 1e15 and number == int(number) else number


def _from_json(text: str) -> Any:
    def refuse(_: str) -> Any:
        raise ValueError("must be finite")

    try:
        # Python's reader takes NaN and Infinity, unless it is set not to
        value = json.loads(text, parse_constant=refuse)
    except (ValueError, RecursionError):
        raise ValueError("is not a readable list or table") from None
    _require_small(value)
    return value


def _require_small(value: Any) -> None:
    """Raise ValueError if lists and tables are nested too deeply or have too many entries.

    Code that copies and compares such values afterwards calls itself for each level, and is quick for a thousand rows.
    """
    # level by level: a function that calls itself would fail at the depth that is refused here
    level = [value] if isinstance(value, (list, dict)) else []
    for _ in range(DEEPEST):
        inner: list[Any] = []
        for one in level:
            most = PAGE.row_count if isinstance(one, list) else MOST_KEYS
            if len(one) > most:
                raise ValueError(f"has a list or table of {len(one):,} entries; the page takes at most {most:,}")
            entries = one if isinstance(one, list) else one.values()
            inner += [entry for entry in entries if isinstance(entry, (list, dict))]
        level = inner
    if level:
        raise ValueError("is nested too deeply")
