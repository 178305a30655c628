"""The page Disturbances."""
