"""The documentation, served beside the page from where `./run docs` has built it."""

from pathlib import Path
from typing import Any

from tornado.web import RedirectHandler, StaticFileHandler

from railjoule.dashboard.built_documentation import FOLDER, FRONT, is_built
from railjoule.dashboard.look.markup import markup
from railjoule.dashboard.server.refusal import told

NOT_BUILT = "The documentation is not built"
HOW_TO_BUILD = "Run ./run docs in the checkout of railjoule, and load this page anew."
NO_SUCH_PAGE = "There is no such page in the documentation"
LINK = '<p><a href="{}">Go to its front page</a></p>'


class DocumentationHandler(StaticFileHandler):
    """Answers with a file of the built documentation, or with one sentence where it is not built."""

    def prepare(self) -> None:
        """Say how to build what is not there."""
        if not is_built(self.root):
            self.set_status(404)
            self.finish(told(NOT_BUILT, markup("<p>{}</p>", HOW_TO_BUILD)))

    def compute_etag(self) -> str | None:
        """Return what changes with the file: the library's own is kept for as long as the server runs."""
        if not self.absolute_path:
            return None
        status = Path(self.absolute_path).stat()
        return f'"{status.st_mtime_ns:x}-{status.st_size:x}"'

    def write_error(self, status_code: int, **_: Any) -> None:
        """Answer in words, with the way to the front page."""
        front = "../" * self.path_args[0].count("/") or "./"
        self.finish(told(NO_SUCH_PAGE if status_code == 404 else f"Error {status_code}", markup(LINK, front)))


def documentation_patterns(folder: Path = FOLDER) -> list[tuple[Any, ...]]:
    """Return what answers /docs, with the documentation in a folder."""
    return [
        # relative, so that it holds below any prefix
        ("/docs", RedirectHandler, {"url": "docs/", "permanent": False}),
        ("/docs/(.*)", DocumentationHandler, {"path": str(folder), "default_filename": FRONT}),
    ]
