"""What the models of all pages have."""

from typing import Any

import param

from railjoule.core import RailjouleError


def result(kind: type | tuple[type, ...], doc: str) -> Any:
    """Return a parameter that holds a result once there is one."""
    return param.ClassSelector(class_=kind, default=None, allow_None=True, doc=doc)


class PageModel(param.Parameterized):
    """A model that can tell why there is no result."""

    failure = result(RailjouleError, "Why the last request failed.")
