"""The search behind `speed_limits`: regulators that drive under limits of sections, and the limits that cost least."""
