"""The scripts of the page: modules, each sent with all that it imports, so that nothing else has to be loaded."""

import re
from functools import cache
from importlib.resources import files

SCRIPTS = files("railjoule.assets") / "scripts"
IMPORT = re.compile(r'^import \{[^}]+\} from "\./(\w+)\.js";\n', re.MULTILINE)
# only whole lines: within one, `//` may be that of an address
COMMENT = re.compile(r"^ *//.*\n|^\n", re.MULTILINE)
EXPORT = re.compile(r"^export (?=const |function )", re.MULTILINE)


@cache
def source(name: str) -> str:
    """Return a script as it stands in its file."""
    return (SCRIPTS / f"{name}.js").read_text(encoding="utf-8")


@cache
def module(name: str) -> str:
    """Return a module without imports and comments: what it needs stands before it, each module once.

    The modules share their names then, as the browser's tests check.
    """
    needed = (EXPORT.sub("", source(other)) for other in imported(name))
    # what is sent with each figure is sent often
    return COMMENT.sub("", IMPORT.sub("", "".join([*needed, source(name)])))


@cache
def lent(name: str) -> str:
    """Return a plain script that keeps a component ready for the page: it is sent once, not with each of many."""
    # modules are strict by themselves, plain scripts are not
    return f'railjoule.components.{name} = (() => {{\n"use strict";\n{function(name, "render")}}})();\n'


def borrowed(name: str) -> str:
    """Return a module that draws a component with what the page has ready."""
    return f"export const render = (given) => window.railjoule.components.{name}(given);\n"


def imported(name: str) -> list[str]:
    """Return the names of all modules that one needs, those that need no others first."""
    found: list[str] = []
    for other in IMPORT.findall(source(name)):
        found += [one for one in [*imported(other), other] if one not in found]
    return found


@cache
def function(name: str, call: str) -> str:
    """Return the body of a function that ends with a call of one of a module's exports.

    Bokeh loads a module when its first event comes, which may then be overtaken by the next; its formatters take none.

    Parameters
    ----------
    name : str
        Of the module.
    call : str
        An expression in the arguments of the function.
    """
    return f"{EXPORT.sub('', module(name))}return {call};\n"
