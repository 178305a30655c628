"""Scripts, style sheets and fonts of the libraries: small to send, packed once, and kept by browsers."""

import asyncio
import gzip
from functools import lru_cache
from pathlib import Path

from tornado.web import StaticFileHandler

NAMED_BY_CONTENT = "public, max-age=31536000, immutable"
"""Of files that are asked for with a version: another content has another address."""
A_DAY = "public, max-age=86400"
PACKED = frozenset({".css", ".html", ".js", ".json", ".mjs", ".svg"})
"""What becomes smaller."""
SMALLEST_BYTES = 1024
"""Below that, packing saves nothing that anyone notices."""
MAX_FILES = 200


@lru_cache(maxsize=MAX_FILES)
def packed(path: str, changed_ns: int) -> bytes:
    """Return a file packed by gzip; it is packed anew when it has changed."""
    return gzip.compress(Path(path).read_bytes(), compresslevel=9, mtime=0)


class KeptFileHandler(StaticFileHandler):
    """Adds to a handler of files what browsers and the server keep of them."""

    def set_extra_headers(self, path: str) -> None:
        """Say for how long a browser need not ask again."""
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
