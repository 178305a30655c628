"""Counts of this process for programs that watch it, in the text format of Prometheus."""

from collections.abc import Iterator

from tornado.web import RequestHandler

from railjoule.dashboard.work.events import TALLY

try:
    from prometheus_client import CONTENT_TYPE_LATEST, CollectorRegistry, ProcessCollector, generate_latest
    from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, Metric
    from prometheus_client.registry import Collector
except ImportError:
    REGISTRY = None
else:

    class Counts(Collector):
        """The counts of `TALLY`, as they are when somebody asks."""

        def collect(self) -> Iterator[Metric]:
            """Yield sessions, queue, pieces of work, and how long they kept pages waiting."""
            yield GaugeMetricFamily("railjoule_sessions", "Pages that are open.", TALLY.sessions)
            yield GaugeMetricFamily("railjoule_queue", "Pieces of work that wait or are under way.", TALLY.queued)
            work = CounterMetricFamily(
                "railjoule_work", "Pieces of work done; compute_runs are moves.", labels=("work", "outcome")
            )
            for labels, count in sorted(TALLY.counts.items()):
                work.add_metric(labels, count)
            yield work
            waits = GaugeMetricFamily(
                "railjoule_wait_p95_seconds", "Wait that 95 % of the last pieces of work kept.", labels=("work",)
            )
            for name, duration_s in sorted(TALLY.percentiles_s(PERCENTILE).items()):
                waits.add_metric((name,), duration_s)
            yield waits

    # one of its own: libraries may count what they like in that of the process
    REGISTRY = CollectorRegistry()
    REGISTRY.register(Counts())
    # memory and processor time, where the system tells them
    ProcessCollector(registry=REGISTRY)

PERCENTILE = 0.95
NOT_IMPLEMENTED = 501
WITHOUT = "Metrics need the package prometheus_client: pip install 'railjoule[metrics]'.\n"


class MetricsHandler(RequestHandler):
    """Answers with all counts, or with a sentence on what to install."""

    def _log(self) -> None:
        """Write down nothing: who watches asks often."""

    def get(self) -> None:
        """Write the counts down."""
        self.set_header("Content-Type", "text/plain; charset=utf-8")
        if REGISTRY is None:
            self.set_status(NOT_IMPLEMENTED)
            self.finish(WITHOUT)
            return
        self.set_header("Content-Type", CONTENT_TYPE_LATEST)
        self.finish(generate_latest(REGISTRY))

    def head(self) -> None:
        """Answer as `get`; tornado sends no body."""
        self.get()
