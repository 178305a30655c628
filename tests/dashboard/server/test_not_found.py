from tornado.testing import AsyncHTTPTestCase
from tornado.web import Application

from railjoule.dashboard.server.not_found import NotFoundHandler


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
        text = self.fetch("/%3Cscript%3Ealert(1)%3C/script%3E").body.decode()
        assert "<script" not in text

    def test_long_addresses_are_cut(self) -> None:
        assert len(self.fetch("/" + "a" * 5000).body) < 10_000

    def test_other_methods_are_answered_alike(self) -> None:
        assert self.fetch("/nope", method="POST", body="").code == 404
