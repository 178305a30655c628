"""Answers of the server beside its pages: health, addresses that lead nowhere; and its log."""
