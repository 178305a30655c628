import os
from pathlib import Path

import pytest
from tornado.testing import AsyncHTTPTestCase
from tornado.web import Application

from railjoule.dashboard.provenance import FOLDER
from railjoule.dashboard.server.answers import extra_patterns
from railjoule.dashboard.server.guard import guard
from railjoule.dashboard.server.options import ServerOptions


class Served(AsyncHTTPTestCase):
    __test__ = False

    @pytest.fixture(autouse=True)
    def folder_of_pages(self, tmp_path: Path) -> None:
        self.folder = tmp_path / "docs"

    def get_app(self) -> Application:
        application = Application(extra_patterns(self.folder))
        guard(application, ServerOptions(), lambda: 0)
        return application


class TestBuilt(Served):
    __test__ = True

    def get_app(self) -> Application:
        (self.folder / "howto").mkdir(parents=True)
        for name in ("index.html", "howto/index.html"):
            (self.folder / name).write_text(f"<p>{name}</p>", encoding="utf-8")
        (self.folder.parent / "secret.txt").write_text("nobody's business", encoding="utf-8")
        return super().get_app()

    def test_pages_are_served_under_the_content_policy(self) -> None:
        for path, text in (("/docs/", "index.html"), ("/docs/howto/", "howto/index.html"), ("/docs", "index.html")):
            answer = self.fetch(path)
            assert answer.code == 200
            assert answer.body.decode() == f"<p>{text}</p>"
            assert "default-src 'self'" in answer.headers["Content-Security-Policy"]

    def test_the_way_there_holds_below_any_prefix(self) -> None:
        assert self.fetch("/docs", follow_redirects=False).headers["Location"] == "docs/"

    def test_what_is_built_anew_is_sent_anew(self) -> None:
        first = self.fetch("/docs/index.html").headers["Etag"]
        assert self.fetch("/docs/index.html", headers={"If-None-Match": first}).code == 304
        page = self.folder / "index.html"
        page.write_text("<p>another</p>", encoding="utf-8")
        os.utime(page, (2e9, 2e9))
        again = self.fetch("/docs/index.html", headers={"If-None-Match": first})
        assert (again.code, again.body) == (200, b"<p>another</p>")

    def test_an_unknown_page_leads_to_the_front_page(self) -> None:
        for path, front in (("/docs/nope.html", "./"), ("/docs/a/nope.html", "../")):
            answer = self.fetch(path)
            assert answer.code == 404
            assert "There is no such page in the documentation" in answer.body.decode()
            assert f'href="{front}"' in answer.body.decode()

    def test_nothing_beside_it_is_served(self) -> None:
        for path in ("/docs/../secret.txt", "/docs/%2e%2e/secret.txt", "/docs/..%2fsecret.txt"):
            answer = self.fetch(path)
            assert answer.code in {403, 404}
            assert b"nobody" not in answer.body


class TestNotBuilt(Served):
    __test__ = True

    def test_one_sentence_says_how_to_build_it(self) -> None:
        for path in ("/docs/", "/docs/howto/index.html"):
            answer = self.fetch(path)
            assert answer.code == 404
            assert "Run ./run docs in the checkout of railjoule" in answer.body.decode()


def test_it_lies_where_run_builds_it() -> None:
    root = Path(__file__).parents[3]
    assert root / "build" / "docs" == FOLDER
    assert "assets/docs build/docs" in (root / "run").read_text(encoding="utf-8")
