"""Scenes with surfaces that can be turned."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import param
from panel.custom import JSComponent

from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.look.scripts import module
from railjoule.dashboard.look.tokens import FONT
from railjoule.dashboard.look.words import slug

CIVIDIS = (
    "#00224E",
    "#123570",
    "#3B496C",
    "#575D6D",
    "#707173",
    "#8A8678",
    "#A59C74",
    "#C3B369",
    "#E1CC55",
    "#FEE838",
)
"""Energy from cheap to dear."""
TALLEST = 3.2
"""The surface is cut off at this many times its least energy: where ramps nearly fill the time it rises without end."""
CAMERA = {"eye": {"x": 1.52, "y": -1.36, "z": 0.72}, "center": {"x": 0.03, "y": 0.02, "z": -0.23}}
NARROW_PX, NARROW_DISTANCE = 420, 1.35
AXES = ("x", "y", "z")
BUTTONS = [["toImage", "resetCameraDefault3d"]]
LIGHTING = {"ambient": 0.85, "diffuse": 0.35, "specular": 0.02, "roughness": 0.9}


def round_step(least: float) -> float:
    """Return the smallest of 1, 2, 2.5 and 5 times a power of ten that is not below a number."""
    power = 10.0 ** np.floor(np.log10(max(least, 1e-9)))
    # rounding must not lift a step that is round already to the next one
    return float(next(factor * power for factor in (1, 2, 2.5, 5, 10) if factor * power >= least * (1 - 1e-9)))


class Scene(JSComponent):
    """A scene that can be turned, with buttons to turn it back and to save a picture.

    Parameters
    ----------
    height : int
    name : str
        The name of the saved picture.
    """

    traces = param.List(default=[], doc="Surfaces, lines and marks, as plotly.js takes them.")
    frame = param.Dict(default={}, doc="Axes, camera and colours, as plotly.js takes them.")
    options = param.Dict(default={}, doc="Buttons, as plotly.js takes them.")

    _esm = module("scene")

    def __init__(self, height: int, name: str) -> None:
        picture = {"filename": slug(name), "scale": 2}
        options = {"displaylogo": False, "modeBarButtons": BUTTONS, "toImageButtonOptions": picture}
        super().__init__(options=options, sizing_mode="stretch_width", height=height, margin=0)

    def draw(self, traces: Sequence[Mapping[str, Any]], frame: dict[str, Any]) -> None:
        """Draw traces, whose arrays are sent as lists."""
        plain = [
            {name: np.asarray(one).tolist() if name in AXES else one for name, one in trace.items()} for trace in traces
        ]
        self.param.update(traces=plain, frame=frame)


def scene_layout(
    palette: Palette, titles: tuple[str, str], bottom: float, top: float, distance: float = 1.0
) -> dict[str, Any]:
    """Return the layout of a surface over two titled axes; its heights go from `bottom` to `top`."""
    tokens = palette.tokens

    def axis(title: str, **more: Any) -> dict[str, Any]:
        return {
            "title": {"text": title, "font": {"size": 12, "color": tokens["ink2"], "family": FONT}},
            # the walls would stay white in the dark
            "showbackground": False,
            "gridcolor": tokens["line"],
            "linecolor": tokens["line2"],
            "zeroline": False,
            "color": tokens["ink3"],
            "tickfont": {"size": 11, "family": FONT},
            "showspikes": False,
            **more,
        }

    return {
        "margin": {"l": 0, "r": 0, "t": 0, "b": 2},
        "paper_bgcolor": tokens["surface"],
        "modebar": {"bgcolor": "rgba(0, 0, 0, 0)", "color": tokens["ink3"], "activecolor": tokens["ink2"]},
        "showlegend": False,
        "font": {"family": FONT},
        # what the reader has turned stays so when the data change
        "uirevision": "keep",
        "scene": {
            "bgcolor": tokens["surface"],
            "camera": {**CAMERA, "eye": {axis: distance * place for axis, place in CAMERA["eye"].items()}},
            "aspectratio": {"x": 1.3, "y": 1.05, "z": 0.8},
            "xaxis": axis(titles[0]),
            "yaxis": axis(titles[1]),
            # without a title, which would be cut off: the caption names the height
            "zaxis": axis("", range=[bottom - 0.02 * (top - bottom), top], nticks=5),
        },
    }
