"""What one open page knows: Param models around the core's frozen values."""
