"""The dashboard, which looks often for closed sessions to forget, and with /pages, which counts living pages."""

import gc
import sys

from tornado.web import RequestHandler

from railjoule.core.compilation import compilation
from railjoule.dashboard.app import make_server, run
from railjoule.dashboard.server.options import ServerOptions
from railjoule.dashboard.shell.shell import Page

LOOKS_EVERY_MS = 1000


class PagesHandler(RequestHandler):
    """Counts the pages that are alive."""

    def get(self) -> None:
        gc.collect()
        self.finish(str(sum(isinstance(thing, Page) for thing in gc.get_objects())))


if __name__ == "__main__":
    port = int(sys.argv[sys.argv.index("--port") + 1])
    compilation().begin()
    watched = ("/pages", PagesHandler)
    run(make_server(ServerOptions(port=port), watched, check_unused_sessions_milliseconds=LOOKS_EVERY_MS))
