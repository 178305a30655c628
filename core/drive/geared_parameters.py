"""The numbers with which the parameters of every drive of geared motors begin."""

PARAMETERS = ("motors", "turns_per_metre", "gear_loss_share", "negligible_effort_n")
"""What they are, in order; those of the losses of a motor follow."""

MOTORS, TURNS, GEAR_LOSS, NEGLIGIBLE = range(4)
LOSSES = len(PARAMETERS)
"""Where those of the losses begin."""
