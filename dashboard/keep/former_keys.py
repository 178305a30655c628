"""Keys and pages of earlier addresses, so that their links still open."""

from collections.abc import Container, Mapping

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
