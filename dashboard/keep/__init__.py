"""What outlasts a page: the address, undo, pinned runs, files, and the page itself where the connection is lost."""
