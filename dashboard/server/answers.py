"""Answers of the server beside its pages: files, its health, the documentation, and messages in words."""

import asyncio
import gzip
from functools import lru_cache
from pathlib import Path
from typing import Any

from tornado.web import RedirectHandler, RequestHandler, StaticFileHandler

from railjoule.core import load_scenario, solve
from railjoule.core.compiled import MODE
from railjoule.dashboard.look.markup import Markup, markup
from railjoule.dashboard.look.theme import bare_css
from railjoule.dashboard.provenance import FOLDER, FRONT, is_built

NOT_FOUND, SERVICE_UNAVAILABLE = 404, 503
PAGE = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title} - railjoule</title><style>{css}
main {{ max-width: 560px; margin: 14vh auto 0; padding: 0 20px; font: 14px/1.5 var(--rj-font); color: var(--rj-ink); }}
h1 {{ margin: 0 0 6px; font-size: 20px; font-weight: 600; overflow-wrap: anywhere; }}
a {{ color: var(--rj-accent); }}
</style></head><body><main><h1>{title}</h1>{text}</main></body></html>
"""
LONGEST_SHOWN = 60
NO_PAGE = """<p>railjoule has one page; what it shows stands behind the question mark of its address.</p>
<p><a href="{}">Go to the front page</a></p>"""
SMALL_SCENARIO = "liashenko-i"
NAMED_BY_CONTENT = "public, max-age=31536000, immutable"
"""Of files that are asked for with a version: another content has another address."""
A_DAY = "public, max-age=86400"
PACKED = frozenset({".css", ".html", ".js", ".json", ".mjs", ".svg"})
"""Suffixes of the files that compress well."""
SMALLEST_BYTES, MAX_FILES = 1024, 200
"""Below that, packing saves nothing that anyone notices; and as many packed files are kept."""


# ---- in words


def message_page(title: str, text: Markup) -> Markup:
    """Return a page with a title and a text below it."""
    return markup(PAGE, css=Markup(bare_css()), title=title, text=text)


class RefusalHandler(RequestHandler):
    """Answers every method with a status, a title and one sentence."""

    def initialize(self, status: int, title: str, advice: str, again_after_s: int = 0) -> None:
        """Take what is answered, and after how many seconds a browser asks again by itself; 0 for never."""
        self._status, self._title, self._advice = status, title, advice
        self._again_after_s = again_after_s

    def prepare(self) -> None:
        """Send the message."""
        self.set_status(self._status)
        if self._again_after_s:
            self.set_header("Retry-After", str(self._again_after_s))
            self.set_header("Refresh", str(self._again_after_s))
        self.finish(message_page(self._title, markup("<p>{}</p>", self._advice)))


class NotFoundHandler(RequestHandler):
    """Answers every address that nothing else answers."""

    def prepare(self) -> None:
        """Answer in words, with the way to the front page, which a proxy may serve under any path."""
        self.set_status(NOT_FOUND)
        path = self.request.path
        shown = path if len(path) <= LONGEST_SHOWN else path[: LONGEST_SHOWN - 3] + "..."
        front = "../" * (path.count("/") - 1) or "./"
        self.finish(message_page(f"There is no page {shown}", markup(NO_PAGE, front)))


class DocumentationHandler(StaticFileHandler):
    """Answers with a file of the documentation that `./run docs` has built, or in words where it is not there."""

    def prepare(self) -> None:
        """Send the way to build the documentation if it is not built."""
        if not is_built(self.root):
            self.set_status(NOT_FOUND)
            build = "Run ./run docs in the checkout of railjoule, and load this page again."
            self.finish(message_page("The documentation is not built", markup("<p>{}</p>", build)))

    def compute_etag(self) -> str | None:
        """Return a tag that changes with the file; the one of the library never changes while the server runs."""
        if not self.absolute_path:
            return None
        status = Path(self.absolute_path).stat()
        return f'"{status.st_mtime_ns:x}-{status.st_size:x}"'

    def write_error(self, status_code: int, **_: Any) -> None:
        """Answer in words, with the way to the front page."""
        front = "../" * self.path_args[0].count("/") or "./"
        title = "There is no such page in the documentation" if status_code == NOT_FOUND else f"Error {status_code}"
        self.finish(message_page(title, markup('<p><a href="{}">Go to its front page</a></p>', front)))


# ---- for programs that watch the server


# Panel's own check of liveness only makes a document: it answers 200 even if every page fails
class HealthHandler(RequestHandler):
    """Answers 503 while kernels compile, then 200: with the energy of a small run, or only that pages can compute."""

    def initialize(self, solves: bool) -> None:
        """Set whether a run is solved; a proxy needs only to learn that pages can compute."""
        self._solves = solves

    def _log(self) -> None:
        """Write down nothing: who waits for the server asks often."""

    def get(self) -> None:
        """Solve, once the kernels are ready."""
        if not MODE.is_compiled:
            self.set_status(SERVICE_UNAVAILABLE)
            self.finish({"status": "starting"})
        elif not self._solves:
            self.finish({"status": "ready"})
        else:
            run = solve(load_scenario(SMALL_SCENARIO))
            self.finish({"status": "ok", "energy_kwh": run.energy_kwh, "solve_time_s": run.solve_time_s})

    def head(self) -> None:
        """Answer as `get`; tornado sends no body."""
        self.get()


# ---- files


@lru_cache(maxsize=MAX_FILES)
def packed(path: str, changed_ns: int) -> bytes:
    """Return a file packed by gzip; it is packed again when it has changed."""
    return gzip.compress(Path(path).read_bytes(), compresslevel=9, mtime=0)


class KeptFileHandler(StaticFileHandler):
    """Answers with scripts, style sheets and fonts of the libraries: packed once, and kept by browsers."""

    def set_extra_headers(self, path: str) -> None:
        """Set for how long a browser may use its copy."""
        super().set_extra_headers(path)
        self.set_header("Cache-Control", NAMED_BY_CONTENT if self.request.query else A_DAY)

    async def get(self, path: str, include_body: bool = True) -> None:
        """Answer with the packed file where the browser takes it, which the event loop neither packs nor reads."""
        self.path = self.parse_url_path(path)
        found = self.validate_absolute_path(self.root, self.get_absolute_path(self.root, self.path))
        if found is None:
            return
        if not self._is_packed(Path(found)):
            await super().get(path, include_body)
            return
        self.absolute_path = found
        self.modified = self.get_modified_time()
        self.set_headers()
        self.set_header("Content-Encoding", "gzip")
        if self.should_return_304():
            self.set_status(304)
            return
        body = await asyncio.to_thread(packed, found, Path(found).stat().st_mtime_ns)
        self.set_header("Content-Length", len(body))
        if include_body:
            self.write(body)

    def _is_packed(self, file: Path) -> bool:
        """Return whether a file is sent packed: part of one is not."""
        asked = self.request.headers
        takes = "gzip" in asked.get("Accept-Encoding", "") and "Range" not in asked
        return takes and file.suffix in PACKED and file.stat().st_size >= SMALLEST_BYTES


def extra_patterns(documentation: Path = FOLDER) -> list[tuple[Any, ...]]:
    """Return all addresses beside the pages, with their handlers."""
    return [
        ("/health", HealthHandler, {"solves": True}),
        ("/ready", HealthHandler, {"solves": False}),
        # relative, so that it holds below any prefix
        ("/docs", RedirectHandler, {"url": "docs/", "permanent": False}),
        ("/docs/(.*)", DocumentationHandler, {"path": str(documentation), "default_filename": FRONT}),
    ]
