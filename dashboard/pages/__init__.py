"""The pages, one room each: its state, its work, what it computes and what it shows."""
