import json

import pytest
from tornado.testing import AsyncHTTPTestCase
from tornado.web import Application

from railjoule.core import load_scenario, solve
from railjoule.dashboard.app import EXTRA_PATTERNS
from railjoule.dashboard.work.warmup import warmup


@pytest.fixture(scope="module", autouse=True)
def _ready() -> None:
    warmup().start()
    assert warmup().ready.wait(240)


class TestHealth(AsyncHTTPTestCase):
    def get_app(self) -> Application:
        return Application(EXTRA_PATTERNS)

    def test_it_solves(self) -> None:
        answer = json.loads(self.fetch("/health").body)
        assert answer["status"] == "ok"
        assert answer["energy_kwh"] == pytest.approx(solve(load_scenario("liashenko-i")).energy_kwh)
