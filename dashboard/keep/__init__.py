"""State that outlasts a page: address, undo, pinned runs, files, and the page itself after a lost connection."""
