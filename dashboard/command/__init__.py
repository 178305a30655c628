"""What a terminal asks for and is told."""
