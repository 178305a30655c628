"""Pieces of HTML and fields that pages are put together from."""
