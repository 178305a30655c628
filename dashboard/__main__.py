"""`python -m railjoule.dashboard` runs the command `railjoule`, and serves the page where no command is named."""

import sys

from railjoule.dashboard.command.cli import main

sys.exit(main(sys.argv[1:] or ["serve"]))
