import sys
from importlib import reload
from pathlib import Path

import pytest
from tornado.testing import AsyncHTTPTestCase
from tornado.web import Application

from railjoule.dashboard.server import metrics
from railjoule.dashboard.work.events import TALLY, Tally

WORK = "compute_of_a_test"


class TestMetrics(AsyncHTTPTestCase):
    def get_app(self) -> Application:
        return Application([("/metrics", metrics.MetricsHandler)])

    def test_it_counts(self) -> None:
        for duration_s in (0.1, 0.2):
            TALLY.took(WORK, "ok", duration_s)
        TALLY.took(WORK, "refused", 0.3)
        text = self.fetch("/metrics").body.decode()
        lines = dict(line.rsplit(" ", 1) for line in text.splitlines() if not line.startswith("#"))
        assert float(lines[f'railjoule_work_total{{outcome="ok",process="1",work="{WORK}"}}']) == 2
        assert float(lines[f'railjoule_work_total{{outcome="refused",process="1",work="{WORK}"}}']) == 1
        assert float(lines[f'railjoule_wait_p95_seconds{{process="1",work="{WORK}"}}']) == 0.3
        assert float(lines['railjoule_sessions{process="1"}']) == TALLY.sessions
        assert float(lines['railjoule_queue{process="1"}']) == TALLY.queued
        # of a program with NumPy and numba
        assert float(lines['process_resident_memory_bytes{process="1"}']) > 50e6
        assert (self.fetch("/metrics", method="HEAD").code, self.fetch("/metrics", method="HEAD").body) == (200, b"")

    def test_without_the_package_it_says_what_to_install(self) -> None:
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(metrics, "REGISTRY", None)
            answer = self.fetch("/metrics")
        assert answer.code == 501
        assert answer.body.decode() == metrics.WITHOUT
        assert "pip install 'railjoule[metrics]'" in metrics.WITHOUT


def test_any_process_tells_what_all_have_counted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(metrics.Telling, "here", None)
    other = metrics.Telling(tmp_path, 1)
    monkeypatch.setattr(metrics, "TALLY", Tally())
    metrics.TALLY.opened(3)
    other.tell()
    asked = metrics.Telling(tmp_path, 0)
    monkeypatch.setattr(metrics, "TALLY", Tally())
    # what it has told before is not what it has now
    asked.tell()
    metrics.TALLY.opened(1)
    counts = metrics.all_counts()
    assert {number: one["sessions"] for number, one in counts.items()} == {"1": 1, "2": 3}
    assert 'railjoule_sessions{process="2"} 3.0' in metrics.generate_latest(metrics.REGISTRY).decode()


def test_counts_that_cannot_be_told_are_left_out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(metrics.Telling, "here", None)
    metrics.Telling(tmp_path / "gone", 0).tell()
    assert list(metrics.all_counts()) == ["1"]


def test_the_package_need_not_be_there() -> None:
    with pytest.MonkeyPatch.context() as patch:
        for name in [name for name in sys.modules if name.partition(".")[0] == "prometheus_client"]:
            patch.delitem(sys.modules, name)
        # what stands for no module at all
        patch.setitem(sys.modules, "prometheus_client", None)
        assert reload(metrics).REGISTRY is None
    assert reload(metrics).REGISTRY is not None
