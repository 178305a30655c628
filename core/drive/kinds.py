"""The numbers by which compiled code knows the kinds of drives."""

CONSTANT_EFFICIENCY = 0
COPPER_LOSS = 1
INDUCTION = 2
LOSS_POLYNOMIAL = 3
LOSS_MAP = 4
