from tornado.httpclient import HTTPResponse
from tornado.testing import AsyncHTTPTestCase
from tornado.web import Application, HTTPError, RequestHandler

from railjoule.dashboard.server.answers import NotFoundHandler
from railjoule.dashboard.server.guard import HEADERS, guard
from railjoule.dashboard.server.options import ServerOptions


class Page(RequestHandler):
    """Stands for the page: large, and with what a library may say to other sites."""

    def get(self) -> None:
        self.set_header("Access-Control-Allow-Origin", "*")
        self.finish("railway " * 1000)


class Broken(RequestHandler):
    def get(self) -> None:
        raise HTTPError(500)


class Guarded(AsyncHTTPTestCase):
    """A server of a page below a prefix, with two places."""

    open_pages = 0

    def get_app(self) -> Application:
        patterns = [("/rail/", Page), ("/rail/autoload.js", Page), ("/rail/broken", Broken)]
        application = Application(patterns, default_handler_class=NotFoundHandler)  # type: ignore[arg-type]
        options = ServerOptions(origins=("railways.example:8080",), prefix="/rail", sessions=2)
        guard(application, options, lambda: self.open_pages)
        return application

    def answer(self, path: str, **headers: str) -> HTTPResponse:
        return self.fetch(path, headers=headers, decompress_response=False)


class TestHeaders(Guarded):
    def test_each_answer_has_them_and_none_names_the_program(self) -> None:
        for path, code in (("/rail/", 200), ("/rail/broken", 500), ("/nowhere", 404)):
            found = self.answer(path)
            assert found.code == code
            assert HEADERS.items() <= dict(found.headers.get_all()).items()
            assert "Server" not in found.headers
            assert "Access-Control-Allow-Origin" not in found.headers

    def test_what_is_large_is_sent_small(self) -> None:
        plain, small = self.answer("/rail/"), self.answer("/rail/", **{"Accept-Encoding": "gzip"})
        assert len(plain.body) == 8000
        assert small.headers["Content-Encoding"] == "gzip"
        assert len(small.body) < 200


class TestHosts(Guarded):
    def test_own_names_are_answered_with_any_port(self) -> None:
        for host in (
            "localhost",
            "127.0.0.1:1",
            "LOCALHOST:5006",
            "railways.example",
            "RAILWAYS.example:80",
        ):
            assert self.answer("/rail/", Host=host).code == 200, host

    def test_others_are_refused_in_words_wherever_they_ask(self) -> None:
        for host in ("evil.example", "localhost.evil.example", "evil.example:5006", "127.0.0.2", "[::1]:5006"):
            for path in ("/rail/", "/rail/autoload.js", "/nowhere"):
                found = self.answer(path, Host=host)
                assert found.code == 421, host
                assert b"railjoule serve --origin NAME" in found.body


class TestOtherSites(Guarded):
    def test_no_other_site_can_open_pages_here(self) -> None:
        assert self.answer("/rail/autoload.js?bokeh-autoload-element=1").code == 404


class TestPlaces(Guarded):
    def test_a_page_too_many_is_refused_in_words_and_others_go_on(self) -> None:
        self.open_pages = 1
        assert self.answer("/rail/?v=1").code == 200
        self.open_pages = 2
        found = self.answer("/rail/?v=1")
        assert found.code == 503
        assert b"keeps 2 pages open" in found.body
        assert found.headers["Refresh"] == found.headers["Retry-After"] == "3"
        assert self.answer("/rail/broken").code == 500
