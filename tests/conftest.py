"""Settings that all tests share."""

import os

from hypothesis import settings

# what commands print is wrapped to the terminal, and not every runner has one
os.environ["COLUMNS"] = "120"

# examples are drawn alike in every run, and no run fails because the machine is busy
settings.register_profile("railjoule", deadline=None, derandomize=True, max_examples=30)
settings.load_profile("railjoule")
