"""The page Motor."""
