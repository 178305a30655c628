"""Rules of all answers of the server: headers, accepted names, and the number of open pages.

The page has no login, and its address holds its whole state. So a browser may send the address to nobody, may run no
script but railjoule's, and may not show the page within another site's; and a request is answered only if it calls the
server by a name that it has. Otherwise a site of any name could let its own name point to this machine, and then
read these pages from a visitor's browser.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from tornado.httputil import HTTPHeaders, HTTPServerRequest
from tornado.routing import HostMatches, Matcher, PathMatches, Rule
from tornado.web import Application, GZipContentEncoding, OutputTransform

from railjoule.dashboard.server.answers import SERVICE_UNAVAILABLE, NotFoundHandler, RefusalHandler
from railjoule.dashboard.server.options import ServerOptions

HEADERS = {
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Permissions-Policy": "camera=(), geolocation=(), microphone=()",
    "Content-Security-Policy": "; ".join(
        (
            "default-src 'self'",
            # Bokeh makes functions of the text that it is sent, and Panel loads components from blobs
            "script-src 'self' 'unsafe-inline' 'unsafe-eval' blob:",
            "style-src 'self' 'unsafe-inline'",
            "img-src 'self' data: blob:",
            "font-src 'self' data:",
            # browsers do not agree on whether 'self' holds for websockets
            "connect-src 'self' ws: wss: blob: data:",
            "worker-src 'self' blob:",
            "object-src 'none'",
            "base-uri 'none'",
            "form-action 'self'",
            "frame-ancestors 'self'",
        )
    ),
}
MISDIRECTED = 421
NO_SUCH_HOST = {
    "status": MISDIRECTED,
    "title": "This server has no such name",
    "advice": "Its operator can add the name in your browser's address: railjoule serve --origin NAME.",
}
FULL = {
    "status": SERVICE_UNAVAILABLE,
    "title": "All places are taken",
    "advice": "This server keeps {} pages open at a time. Yours opens by itself once there is a place.",
    # a reload waits once too: the browser asks before it leaves the place that it had
    "again_after_s": 3,
}


class SafeHeaders(OutputTransform):
    """Gives each answer of any handler the headers of this server."""

    def transform_first_chunk(
        self, status_code: int, headers: HTTPHeaders, chunk: bytes, finishing: bool
    ) -> tuple[int, HTTPHeaders, bytes]:
        """Add the headers, and take away the one that names the program."""
        for name, value in HEADERS.items():
            headers[name] = value
        headers.pop("Server", None)
        # only what we name ourselves may be read by other sites: nothing
        headers.pop("Access-Control-Allow-Origin", None)
        headers.pop("Access-Control-Allow-Credentials", None)
        return status_code, headers, chunk


@dataclass(frozen=True)
class NoPlace(Matcher):
    """Matches requests for a further page where enough are open."""

    path: str
    sessions: int
    count: Callable[[], int]

    def match(self, request: HTTPServerRequest) -> dict[str, Any] | None:
        """Return no arguments, or None where there is a place."""
        return None if request.path != self.path or self.count() < self.sessions else {}


def guard(application: Application, options: ServerOptions, count: Callable[[], int]) -> None:
    """Let a server answer as `options` say.

    Parameters
    ----------
    application : Application
        With all its pages.
    options : ServerOptions
    count : callable
        Returns how many pages are open.
    """
    application.add_transform(SafeHeaders)
    application.add_transform(GZipContentEncoding)
    own = "|".join(map(re.escape, options.names))
    rules = [
        Rule(HostMatches(re.compile(rf"(?!(?:{own})\Z)", re.IGNORECASE)), RefusalHandler, NO_SUCH_HOST),
        # the script by which any other site could open pages here
        Rule(PathMatches(re.escape(f"{options.prefix}/autoload.js")), NotFoundHandler),
    ]
    if options.sessions is not None:
        full = {**FULL, "advice": str(FULL["advice"]).format(options.sessions)}
        rules.append(Rule(NoPlace(f"{options.prefix}/", options.sessions, count), RefusalHandler, full))
    # before the pages' own: the first rule that matches answers
    application.default_router.rules[:0] = rules
