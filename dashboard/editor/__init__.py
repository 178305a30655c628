"""The editor of a scenario."""
