import gzip
import tempfile
from pathlib import Path

from tornado.httpclient import HTTPResponse
from tornado.testing import AsyncHTTPTestCase
from tornado.web import Application

from railjoule.dashboard.server.kept_files import A_DAY, NAMED_BY_CONTENT, KeptFileHandler, packed

SCRIPT = "const railway = 1; " * 200


class TestKeptFiles(AsyncHTTPTestCase):
    def get_app(self) -> Application:
        outer = Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.folder = outer / "served"
        self.folder.mkdir()
        (outer / "secret.js").write_text(SCRIPT)
        (self.folder / "railway.js").write_text(SCRIPT)
        (self.folder / "small.js").write_text("1")
        (self.folder / "font.woff2").write_bytes(bytes(4000))
        return Application([("/static/(.*)", KeptFileHandler, {"path": str(self.folder)})])

    def answer(self, path: str, **headers: str) -> HTTPResponse:
        return self.fetch(f"/static/{path}", headers=headers, decompress_response=False)

    def test_a_large_script_comes_packed_to_whoever_takes_it(self) -> None:
        plain = self.answer("railway.js")
        small = self.answer("railway.js", **{"Accept-Encoding": "gzip, br"})
        assert (plain.body.decode(), plain.headers.get("Content-Encoding")) == (SCRIPT, None)
        assert small.headers["Content-Encoding"] == "gzip"
        assert gzip.decompress(small.body).decode() == SCRIPT
        assert len(small.body) < len(plain.body) / 10

    def test_small_files_fonts_and_parts_come_as_they_are(self) -> None:
        for path, more in (("small.js", {}), ("font.woff2", {}), ("railway.js", {"Range": "bytes=0-4"})):
            found = self.answer(path, **{"Accept-Encoding": "gzip"}, **more)
            assert "Content-Encoding" not in found.headers
        assert found.code == 206
        assert found.body == b"const"

    def test_what_has_a_version_is_kept_for_a_year(self) -> None:
        for encoding in ("", "gzip"):
            assert self.answer("railway.js?v=1", **{"Accept-Encoding": encoding}).headers["Cache-Control"] == (
                NAMED_BY_CONTENT
            )
            assert self.answer("railway.js", **{"Accept-Encoding": encoding}).headers["Cache-Control"] == A_DAY

    def test_what_the_browser_has_is_not_sent_again(self) -> None:
        known = self.answer("railway.js", **{"Accept-Encoding": "gzip"})
        again = self.answer("railway.js", **{"Accept-Encoding": "gzip", "If-None-Match": known.headers["Etag"]})
        assert (again.code, again.body) == (304, b"")

    def test_nothing_beside_the_folder_is_found(self) -> None:
        for path in ("../secret.js", "%2e%2e/secret.js", "missing.js"):
            assert self.answer(path, **{"Accept-Encoding": "gzip"}).code in {403, 404}

    def test_a_changed_file_is_packed_anew(self) -> None:
        file = self.folder / "railway.js"
        file.write_text("const other = 2; " * 200)
        assert gzip.decompress(packed(str(file), 2)) == file.read_bytes()
