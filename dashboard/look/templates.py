"""The templates of HTML: each is a file of its own, read once."""

from functools import cache
from importlib.resources import files

from jinja2 import Environment, StrictUndefined, Template

ENVIRONMENT = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True)
# a browser would refuse all of the data because of one NaN
ENVIRONMENT.policies["json.dumps_kwargs"] = {"separators": (",", ":"), "allow_nan": False}


@cache
def template(name: str) -> Template:
    """Return a template, which escapes all texts that are not marked as HTML."""
    text = (files("railjoule.assets") / "templates" / f"{name}.html").read_text(encoding="utf-8")
    return ENVIRONMENT.from_string(text)
