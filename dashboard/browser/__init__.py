"""What the browser is asked: what is in sight, messages, the bar of pages, files to save."""
