"""The state of one open page: the scenario, what is chosen and what has come out."""
