"""`python -m railjoule.dashboard` runs the command `railjoule`."""

import sys

from railjoule.dashboard.cli import main

sys.exit(main())
