"""What stands around each page: bar, sidebar, sharing."""
