"""Charts that more than one page draws, and what they are made of."""
