"""The page Line."""
