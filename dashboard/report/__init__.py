"""The report: one file of HTML that tells a scenario's results, works without a network, and can be loaded again."""
