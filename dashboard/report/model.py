"""The state of the report that one open page makes."""

import param

from railjoule.dashboard.report.contents import Contents
from railjoule.dashboard.state.page_model import PageModel


class ReportingModel(PageModel):
    """Whether a report is wanted, how far it is, and what came out."""

    wanted = param.Event(doc="The user asks for a report.")
    unwanted = param.Event(doc="The user wants no report any more.")
    contents = param.ClassSelector(class_=Contents, default=Contents(), doc="What the report shall tell.")
    busy = param.Boolean(default=False, doc="Whether a report is being made.")
    share = param.Magnitude(default=0.0, doc="How much of the work is done.")
    name_of_file = param.String(default="report.html", doc="What the file will be called.")
    text = param.String(default="", doc="The report, until it is handed to the browser.")
