"""The pages, one package each, with its state, background work, computation and views."""
