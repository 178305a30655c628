"""The report: one file of HTML with a scenario's results, which works without a network, and can be loaded again."""
