"""The dashboard, none of whose pages can be made."""

import sys

from railjoule.dashboard import app
from railjoule.dashboard.server.options import ServerOptions
from railjoule.dashboard.work.warmup import warmup


def fail() -> None:
    """Make no page."""
    raise RuntimeError("broken on purpose")


if __name__ == "__main__":
    port = int(sys.argv[sys.argv.index("--port") + 1])
    warmup().start()
    app.make_page = fail
    app.write_down()
    app.run(app.make_server(ServerOptions(port=port)))
