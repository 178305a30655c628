"""The dashboard, none of whose pages can be made."""

import sys

from railjoule.core.compilation import compilation
from railjoule.dashboard import app
from railjoule.dashboard.server.options import ServerOptions


def fail() -> None:
    """Make no page."""
    raise RuntimeError("broken on purpose")


if __name__ == "__main__":
    port = int(sys.argv[sys.argv.index("--port") + 1])
    compilation().begin()
    app.make_page = fail
    app.events.write_down()
    app.run(app.make_server(ServerOptions(port=port)))
