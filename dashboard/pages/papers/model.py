"""What the page Papers asks for, and the comparisons that are there."""

import param

from railjoule.dashboard.state.page_model import PageModel


class PapersModel(PageModel):
    """The comparisons so far."""

    results = param.Dict(default={}, doc="Tables of each paper so far.")
    is_current = param.Boolean(default=True, doc="Whether this code has computed all of them, from these assets.")
    under_way = param.Dict(default={}, doc="Tables of the comparisons that are being computed.")
    asked = param.List(default=[], doc="The papers that are being compared, in their order.")
    compare = param.List(default=[], doc="Set to names of papers to compare them.")
    figures = param.Dict(default={}, doc="The computed figures of each paper, in their order.")
    drawing = param.String(default="", doc="The paper whose figures are being computed.")
    draw = param.String(default="", doc="Set to the name of a paper to compute its figures.")
    stop = param.Event(doc="Stop; what is done stands.")
