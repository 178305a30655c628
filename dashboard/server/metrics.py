"""Counts of a server for programs that watch it, in the text format of Prometheus."""

import json
from collections.abc import Iterator, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

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
        """The counts of all processes, each under its number."""

        def collect(self) -> Iterator[Metric]:
            """Yield sessions, queue, pieces of work, how long they kept pages waiting, and what the system tells."""
            told = all_counts()
            sessions = GaugeMetricFamily("railjoule_sessions", "Pages that are open.", labels=("process",))
            queue = GaugeMetricFamily(
                "railjoule_queue", "Pieces of work that wait or are under way.", labels=("process",)
            )
            work = CounterMetricFamily(
                "railjoule_work", "Pieces of work done; compute_runs are moves.", labels=("process", "work", "outcome")
            )
            waits = GaugeMetricFamily(
                "railjoule_wait_p95_seconds", "Wait that 95 % of the last pieces kept.", labels=("process", "work")
            )
            for number, counts in told.items():
                sessions.add_metric((number,), counts["sessions"])
                queue.add_metric((number,), counts["queue"])
                for name, outcome, count in counts["work"]:
                    work.add_metric((number, name, outcome), count)
                for name, duration_s in counts["waits"]:
                    waits.add_metric((number, name), duration_s)
            yield from (sessions, queue, work, waits, *_of_the_system(told))

    def _of_the_system(told: Mapping[str, Mapping[str, Any]]) -> Iterator[Metric]:
        """Yield memory, processor time and files of each process, where its system tells them."""
        for metric in SYSTEM.collect():
            found, name = Metric(metric.name, metric.documentation, metric.type), metric.samples[0].name
            for number, counts in told.items():
                if name in counts["system"]:
                    found.add_sample(name, {"process": number}, counts["system"][name])
            yield found

    # one of its own: libraries may count what they like in that of the process
    REGISTRY = CollectorRegistry()
    REGISTRY.register(Counts())
    SYSTEM = ProcessCollector(registry=None)

PERCENTILE = 0.95
NOT_IMPLEMENTED = 501
WITHOUT = "Metrics need the package prometheus_client: pip install 'railjoule[metrics]'.\n"
FILES = "counts-{}.json"


class Telling:
    """Where the processes of a server tell each other what they count: any of them may be asked for the counts of all.

    Parameters
    ----------
    folder : Path
        One of them all.
    number : int
        Which of them this is, from 0 on.
    """

    here: "Telling | None" = None
    """That of this process, where there are others."""

    def __init__(self, folder: Path, number: int) -> None:
        self._folder, self.number = folder, number
        Telling.here = self

    def tell(self) -> None:
        """Tell the others what this process has counted."""
        own = self._folder / FILES.format(self.number)
        new = own.with_suffix(".new")
        # not by `core.written`, which waits for the disk: all pages would, and nothing is lost with these counts
        with suppress(OSError):
            new.write_text(json.dumps(own_counts()), encoding="utf-8")
            new.replace(own)

    def others(self) -> Iterator[tuple[int, dict[str, Any]]]:
        """Yield what the others have told last, with their numbers."""
        for path in sorted(self._folder.glob(FILES.format("*"))):
            number = int(path.stem.rpartition("-")[2])
            if number != self.number:
                yield number, json.loads(path.read_text(encoding="utf-8"))


def own_counts() -> dict[str, Any]:
    """Return what this process has counted, as plain values."""
    metrics = () if REGISTRY is None else SYSTEM.collect()
    return {
        "sessions": TALLY.sessions,
        "queue": TALLY.queued,
        "work": sorted((*labels, count) for labels, count in TALLY.counts.items()),
        "waits": sorted(TALLY.percentiles_s(PERCENTILE).items()),
        "system": {sample.name: sample.value for metric in metrics for sample in metric.samples},
    }


def all_counts() -> dict[str, Mapping[str, Any]]:
    """Return what each process has counted, by its number from 1 on."""
    here = Telling.here
    if here is None:
        return {"1": own_counts()}
    return {str(number + 1): counts for number, counts in sorted([(here.number, own_counts()), *here.others()])}


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
