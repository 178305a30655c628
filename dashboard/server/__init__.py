"""What the server answers beside its pages: its health, addresses that lead nowhere; and its log."""
