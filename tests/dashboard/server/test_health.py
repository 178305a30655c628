import json

import pytest
from tornado.testing import AsyncHTTPTestCase
from tornado.web import Application

from railjoule.core import load_scenario, solve
from railjoule.core.compiled import MODE
from railjoule.dashboard.app import EXTRA_PATTERNS


class TestHealth(AsyncHTTPTestCase):
    def get_app(self) -> Application:
        return Application(EXTRA_PATTERNS)

    def test_it_solves(self) -> None:
        answer = json.loads(self.fetch("/health").body)
        assert (self.fetch("/health", method="HEAD").code, self.fetch("/health", method="HEAD").body) == (200, b"")
        assert answer["status"] == "ok"
        assert answer["energy_kwh"] == pytest.approx(solve(load_scenario("liashenko-i")).energy_kwh)

    def test_that_pages_can_compute_is_told_without_solving(self) -> None:
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
