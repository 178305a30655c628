"""The answer to an address at which there is nothing."""

from tornado.web import RequestHandler

from railjoule.dashboard.look.markup import markup
from railjoule.dashboard.server.refusal import told

NOT_FOUND = 404
LONGEST_SHOWN = 60
TITLE = "There is no page {}"
TEXT = """<p>railjoule has one page; what it shows stands behind the question mark of its address.</p>
<p><a href="{}">Go to the front page</a></p>"""


class NotFoundHandler(RequestHandler):
    """Answers every address that nothing else answers."""

    def prepare(self) -> None:
        """Answer in words, with the way to the front page, which a proxy may serve under any path."""
        self.set_status(NOT_FOUND)
        path = self.request.path
        shown = path if len(path) <= LONGEST_SHOWN else path[: LONGEST_SHOWN - 3] + "..."
        front = "../" * (path.count("/") - 1) or "./"
        self.finish(told(TITLE.format(shown), markup(TEXT, front)))
