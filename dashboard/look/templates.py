"""The templates of HTML: each is a file of its own, read once."""

from functools import cache
from importlib.resources import files

from jinja2 import Environment, StrictUndefined, Template


@cache
def template(name: str) -> Template:
    """Return a template, which escapes all texts that are not marked as HTML."""
    text = (files("railjoule.assets") / "templates" / f"{name}.html").read_text(encoding="utf-8")
    return Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True).from_string(text)
