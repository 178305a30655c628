"""Claims of the four papers, each examined by runs."""
