"""Settings that all tests share."""

from hypothesis import settings

# examples are drawn alike in every run, and no run fails because the machine is busy
settings.register_profile("railjoule", deadline=None, derandomize=True, max_examples=30)
settings.load_profile("railjoule")
