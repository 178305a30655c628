"""What is in sight of a page: its first words, its charts, and whether anything is where they should be."""

from io import BytesIO
from typing import Any

from PIL import Image
from playwright.sync_api import Page

FEWEST_COLOURS = 12
"""A picture of a drawn chart has at least so many: antialiased lines and text have more, an empty sheet has one."""
LOOK = """
(name) => {
  const holder = Bokeh.index.find_one(Bokeh.documents[0].get_model_by_name(`page ${name}`) ?? {id: ""})?.el;
  const covered = document.getElementById("rj-first") !== null;
  if (covered || !holder?.checkVisibility()) { return {covered: true, words: "", waits: true, charts: []}; }
  const within = (root, selector) => [
    ...root.querySelectorAll(selector),
    ...[...root.querySelectorAll("*")].flatMap((one) => one.shadowRoot ? within(one.shadowRoot, selector) : []),
  ];
  const shown = (selector) => within(holder.shadowRoot, selector).filter((one) => one.checkVisibility());
  const main = railjoule.deep(".main-content")[0].getBoundingClientRect();
  const blank = (canvas) => {
    const small = Object.assign(document.createElement("canvas"), {width: 80, height: 40});
    const context = small.getContext("2d");
    context.drawImage(canvas, 0, 0, 80, 40);
    const points = new Uint32Array(context.getImageData(0, 0, 80, 40).data.buffer);
    return points.every((point) => point === points[0]);
  };
  const charts = shown(".rj-chart").map((place) => {
    const box = place.getBoundingClientRect();
    const canvases = within(place.shadowRoot, "canvas").filter((canvas) => canvas.width && canvas.height);
    // what WebGL has painted cannot be read afterwards
    const solid = within(place.shadowRoot, ".gl-container").length > 0;
    const vector = within(place.shadowRoot, "svg").length > 0;
    return {
      name: [...place.classList].find((one) => one.startsWith("rj-chart-")).slice(9),
      in_sight: box.height > 0 && box.bottom > main.top + 1 && box.top < main.bottom - 1,
      sketched: place.classList.contains("rj-undrawn"),
      drawn: !place.classList.contains("rj-undrawn") && (solid || vector || canvases.some((canvas) => !blank(canvas))),
      solid, box: [box.left, Math.max(box.top, main.top), box.right, Math.min(box.bottom, main.bottom)],
    };
  });
  return {
    covered: false,
    words: shown("h1").map((one) => one.textContent).join(" "),
    numbers: shown(".figure .value, .hero .key b").map((one) => one.textContent.trim()),
    waits: shown(".figures.sketched").length > 0,
    charts,
  };
}
"""


class Sight:
    """What is in sight of one page."""

    def __init__(self, page: Page, name: str) -> None:
        self.page = page
        self._found: dict[str, Any] = page.evaluate(LOOK, name)

    @property
    def heading(self) -> str:
        """The page's heading; empty while another page or a sketch stands before it."""
        return str(self._found["words"])

    @property
    def number(self) -> str:
        """The large number; empty where there is none yet."""
        return "" if self._found["waits"] else next(iter(self._found["numbers"]), "")

    @property
    def charts(self) -> list[dict[str, Any]]:
        """The charts in sight."""
        return [chart for chart in self._found["charts"] if chart["in_sight"]]

    @property
    def holes(self) -> list[str]:
        """Charts in sight where neither the chart nor its sketch stands."""
        return [chart["name"] for chart in self.charts if not (chart["drawn"] or chart["sketched"])]

    @property
    def undrawn(self) -> list[str]:
        """Charts in sight that are not drawn."""
        missing = [chart["name"] for chart in self.charts if not chart["drawn"]]
        return missing + [chart["name"] for chart in self.charts if chart["drawn"] and self._is_empty(chart)]

    def _is_empty(self, chart: dict[str, Any]) -> bool:
        """Whether a picture of a figure in space shows one colour only."""
        if not chart["solid"]:
            return False
        picture = Image.open(BytesIO(self.page.screenshot())).convert("RGB").crop(tuple(map(int, chart["box"])))
        return picture.getcolors(FEWEST_COLOURS) is not None
