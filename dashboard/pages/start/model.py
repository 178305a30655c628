"""What Start shows: the shipped scenarios as cards."""

import param


class StartModel(param.Parameterized):
    """The cards that are there so far."""

    cards = param.List(default=[], doc="Cards of the shipped scenarios.")
