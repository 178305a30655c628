"""An answer in words where a request cannot be served."""

from tornado.web import RequestHandler

from railjoule.dashboard.look.markup import Markup, markup
from railjoule.dashboard.look.theme import bare_css

PAGE = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title} - railjoule</title><style>{css}
main {{ max-width: 560px; margin: 14vh auto 0; padding: 0 20px; font: 14px/1.5 var(--rj-font); color: var(--rj-ink); }}
h1 {{ margin: 0 0 6px; font-size: 20px; font-weight: 600; overflow-wrap: anywhere; }}
a {{ color: var(--rj-accent); }}
</style></head><body><main><h1>{title}</h1>{text}</main></body></html>
"""


def told(title: str, text: Markup) -> Markup:
    """Return a page with a title and what stands below it."""
    return markup(PAGE, css=Markup(bare_css()), title=title, text=text)


class RefusalHandler(RequestHandler):
    """Answers every method with a status, a title and one sentence."""

    def initialize(self, status: int, title: str, advice: str, again_after_s: int = 0) -> None:
        """Take what is answered, and after how many seconds a browser asks again by itself; 0 for never."""
        self._status, self._title, self._advice = status, title, advice
        self._again_after_s = again_after_s

    def prepare(self) -> None:
        """Answer at once."""
        self.set_status(self._status)
        if self._again_after_s:
            self.set_header("Retry-After", str(self._again_after_s))
            self.set_header("Refresh", str(self._again_after_s))
        self.finish(told(self._title, markup("<p>{}</p>", self._advice)))
