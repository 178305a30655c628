"""The page Set speeds."""
