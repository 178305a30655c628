"""A health check that means something: it solves a small scenario."""

from tornado.web import RequestHandler

from railjoule.core import load_scenario, solve
from railjoule.dashboard.work.kernel_parts import SCENARIOS
from railjoule.dashboard.work.warmup import warmup

OK, SERVICE_UNAVAILABLE = 200, 503


# Panel's own check of liveness only makes a document: it says yes where every page fails
class HealthHandler(RequestHandler):
    """Answers 200 with the energy of a small run, 503 while kernels compile: the first page may be open by then."""

    def _log(self) -> None:
        """Write down nothing: who waits for the server asks often."""

    def get(self) -> None:
        """Solve, once the kernels are ready."""
        if not warmup().ready.is_set():
            self.set_status(SERVICE_UNAVAILABLE)
            self.finish({"status": "starting"})
            return
        # one that the warm-up runs too, so that nothing is left to compile
        run = solve(load_scenario(SCENARIOS[0]))
        self.finish({"status": "ok", "energy_kwh": run.energy_kwh, "solve_time_s": run.solve_time_s})

    # who watches a server may ask for the status alone
    head = get


class ReadyHandler(RequestHandler):
    """Answers 200 once a page can compute, 503 before: where a proxy may send visitors."""

    def _log(self) -> None:
        """Write down nothing."""

    def get(self) -> None:
        """Tell whether the kernels are there, without solving anything."""
        is_ready = warmup().ready.is_set()
        self.set_status(OK if is_ready else SERVICE_UNAVAILABLE)
        self.finish({"status": "ready" if is_ready else "starting"})

    head = get
