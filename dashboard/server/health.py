"""A health check that means something: it solves a small scenario."""

from tornado.web import RequestHandler

from railjoule.core import load_scenario, solve
from railjoule.core.compiled import MODE

SERVICE_UNAVAILABLE = 503
SMALL_SCENARIO = "liashenko-i"


class Watched(RequestHandler):
    """Answers programs that watch the server, which may ask for the status alone: 503 while kernels compile."""

    def _log(self) -> None:
        """Write down nothing: who waits for the server asks often."""

    def is_ready(self) -> bool:
        """Return whether the kernels are there, and answer that they are not."""
        if MODE.is_compiled:
            return True
        self.set_status(SERVICE_UNAVAILABLE)
        self.finish({"status": "starting"})
        return False

    def head(self) -> None:
        """Answer as `get`; tornado sends no body."""
        self.get()


# Panel's own check of liveness only makes a document: it says yes where every page fails
class HealthHandler(Watched):
    """Answers 200 with the energy of a small run; the first page may be open before."""

    def get(self) -> None:
        """Solve, once the kernels are ready."""
        if self.is_ready():
            run = solve(load_scenario(SMALL_SCENARIO))
            self.finish({"status": "ok", "energy_kwh": run.energy_kwh, "solve_time_s": run.solve_time_s})


class ReadyHandler(Watched):
    """Answers 200 once pages can compute: where a proxy may send visitors."""

    def get(self) -> None:
        """Tell that the kernels are there, without solving anything."""
        if self.is_ready():
            self.finish({"status": "ready"})
