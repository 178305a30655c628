"""The dashboard, which looks often for closed sessions to forget, and with /pages, which counts living pages."""

import gc
import sys

import panel as pn
from tornado.web import RequestHandler

from railjoule.dashboard.app import EXTRA_PATTERNS, make_page
from railjoule.dashboard.shell.shell import Page
from railjoule.dashboard.work.warmup import warmup

LOOKS_EVERY_MS = 1000


class PagesHandler(RequestHandler):
    """Counts the pages that are alive."""

    def get(self) -> None:
        gc.collect()
        self.finish(str(sum(isinstance(thing, Page) for thing in gc.get_objects())))


if __name__ == "__main__":
    port = int(sys.argv[sys.argv.index("--port") + 1])
    warmup().start()
    pn.serve(
        {"/": make_page},
        port=port,
        show=False,
        websocket_origin=[f"127.0.0.1:{port}"],
        extra_patterns=[*EXTRA_PATTERNS, ("/pages", PagesHandler)],
        check_unused_sessions_milliseconds=LOOKS_EVERY_MS,
    )
