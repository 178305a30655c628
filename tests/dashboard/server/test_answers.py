import gzip
import json
import tempfile
from pathlib import Path

import pytest
from tornado.httpclient import HTTPResponse
from tornado.testing import AsyncHTTPTestCase
from tornado.web import Application

from railjoule.core import load_scenario, solve
from railjoule.core.compiled import MODE
from railjoule.dashboard.app import EXTRA_PATTERNS
from railjoule.dashboard.server.answers import A_DAY, NAMED_BY_CONTENT, KeptFileHandler, NotFoundHandler, packed


class TestNotFound(AsyncHTTPTestCase):
    def get_app(self) -> Application:
        return Application([], default_handler_class=NotFoundHandler)

    def test_an_unknown_address_leads_to_the_front_page(self) -> None:
        for path, front in (("/nope", "./"), ("/a/b/c", "../../")):
            answer = self.fetch(path)
            text = answer.body.decode()
            assert answer.code == 404
            assert f"There is no page {path}" in text
            assert f'href="{front}"' in text

    def test_markup_in_an_address_stays_text(self) -> None:
        assert "<script" not in self.fetch("/%3Cscript%3Ealert(1)%3C/script%3E").body.decode()

    def test_long_addresses_are_cut(self) -> None:
        assert len(self.fetch("/" + "a" * 5000).body) < 10_000

    def test_other_methods_are_answered_alike(self) -> None:
        assert self.fetch("/nope", method="POST", body="").code == 404


class TestHealth(AsyncHTTPTestCase):
    def get_app(self) -> Application:
        return Application(EXTRA_PATTERNS)

    def test_it_solves(self) -> None:
        answer = json.loads(self.fetch("/health").body)
        assert (self.fetch("/health", method="HEAD").code, self.fetch("/health", method="HEAD").body) == (200, b"")
        assert answer["status"] == "ok"
        assert answer["energy_kwh"] == pytest.approx(solve(load_scenario("liashenko-i")).energy_kwh)

    def test_readiness_needs_no_run(self) -> None:
        assert json.loads(self.fetch("/ready").body) == {"status": "ready"}
        assert self.fetch("/ready", method="HEAD").code == 200


class TestStarting(AsyncHTTPTestCase):
    def get_app(self) -> Application:
        return Application(EXTRA_PATTERNS)

    def test_both_say_so_while_kernels_compile(self) -> None:
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(MODE, "is_compiled", False)
            for path in ("/health", "/ready"):
                answer = self.fetch(path)
                assert (answer.code, json.loads(answer.body)) == (503, {"status": "starting"})
                assert self.fetch(path, method="HEAD").code == 503


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

    def test_a_large_script_is_sent_packed_if_the_browser_accepts_it(self) -> None:
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
        assert (found.code, found.body) == (206, b"const")

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

    def test_a_changed_file_is_packed_again(self) -> None:
        file = self.folder / "railway.js"
        file.write_text("const other = 2; " * 200)
        assert gzip.decompress(packed(str(file), 2)) == file.read_bytes()
