"""What the page Disturbances asks for: the events on the way, and the delay that is accepted."""

import param

from railjoule.dashboard.pages.disturbances.compute import LateArrivals, Rides
from railjoule.dashboard.state.kept import Kept
from railjoule.dashboard.state.page_model import PageModel, result


class DisturbancesModel(Kept, PageModel):
    """The results of the page, and the kind of event that a click adds."""

    passing = ("dropping", "as_driver")

    as_driver = param.Boolean(
        default=False, doc="Whether the accepted delay follows the driver's smallest one, until it is set by hand."
    )
    dropping = param.Selector(default="stop", objects=["stop", "limit"], doc="What a click on the track adds.")

    rides = result(Rides, "The last good rides.")
    late = result(LateArrivals, "Energy over lateness so far.")
