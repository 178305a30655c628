// A rectangle that is dragged over a figure: it is seen at once, and the server hears of it once it is let go.

const BEGAN = Symbol.for("railjoule.choice");
const in_order = (one, other) => one < other ? [one, other] : [other, one];

export const drag_choice = ({f, box}, event) => {
  if (event.event_name === "panstart") { f[BEGAN] = event; return; }
  const began = f[BEGAN];
  if (!began) { return; }
  const [left, right] = in_order(began.x, event.x), [bottom, top] = in_order(began.y, event.y);
  box.setv({left, right, bottom, top, visible: true}, {sync: false});
  if (event.event_name === "panend") {
    f[BEGAN] = null;
    // as a text: an object of the browser's would be sent as a map; the count makes each release a change
    box.tags = [JSON.stringify([left, right, bottom, top]), (box.tags[1] ?? 0) + 1];
  }
};
