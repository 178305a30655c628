"""Frame of each page: bar, sidebar, sharing."""
