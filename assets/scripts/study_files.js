// Fetches the file of a study that the server has written.

import {make} from "./dom.js";

export function render({model}) {
  model.on("msg:custom", (event) => {
    const {place, name} = event.data ?? event;
    if (place) { make("a", {href: place, download: name}).click(); }
  });
  return make("span", {hidden: true});
}
