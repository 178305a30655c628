"""The page Speed limits."""
