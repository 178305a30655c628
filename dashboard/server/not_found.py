"""The answer to an address at which there is nothing."""

import html

from tornado.web import RequestHandler

from railjoule.dashboard.look.theme import bare_css

NOT_FOUND = 404
LONGEST_SHOWN = 60
PAGE = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>Not found - railjoule</title><style>{css}
main {{ max-width: 560px; margin: 14vh auto 0; padding: 0 20px; font: 14px/1.5 var(--rj-font); color: var(--rj-ink); }}
h1 {{ margin: 0 0 6px; font-size: 20px; font-weight: 600; overflow-wrap: anywhere; }}
a {{ color: var(--rj-accent); }}
</style></head><body><main><h1>There is no page {path}</h1>
<p>railjoule has one page; what it shows stands behind the question mark of its address.</p>
<p><a href="{front}">Go to the front page</a></p></main></body></html>
"""


class NotFoundHandler(RequestHandler):
    """Answers every address that nothing else answers."""

    def prepare(self) -> None:
        """Answer in words, with the way to the front page, which a proxy may serve under any path."""
        self.set_status(NOT_FOUND)
        path = self.request.path
        # cut before it is escaped, as half an entity is none
        shown = path if len(path) <= LONGEST_SHOWN else path[: LONGEST_SHOWN - 3] + "..."
        front = "../" * (path.count("/") - 1) or "./"
        self.finish(PAGE.format(css=bare_css(), path=html.escape(shown), front=front))
