// A scene of plotly.js, which is larger than all the rest: it is loaded when a page first shows one.

import {life_of, make, redraw_on} from "./dom.js";

let loading = null;
const load = () => loading ??= new Promise((resolve, reject) => {
  const script = make("script", {src: document.getElementById("rj-plotly").dataset.address});
  script.onload = resolve;
  script.onerror = () => { loading = null; reject(new Error("plotly.js could not be loaded")); };
  document.head.append(script);
});
// what the library has written for the document, as a shadow root has nothing of it
const sheet_of_library = () => {
  const {sheet} = document.getElementById("plotly.js-style-global");
  return make("style", {}, [...sheet.cssRules].map((rule) => rule.cssText).join("\n"));
};

export function render({model}) {
  const signal = life_of(model), root = make("div", {style: "width: 100%; height: 100%"});
  let dressed = false;
  const draw = async () => {
    if (!model.traces.length || !root.clientWidth) { return; }
    if (!window.Plotly) { await load(); }
    const {clientWidth: width, clientHeight: height} = root;
    if (signal.aborted || !width) { return; }
    if (!dressed) { root.before(sheet_of_library()); }
    dressed = true;
    window.Plotly.react(root, model.traces, {...model.frame, width, height}, model.options);
  };
  const observer = new ResizeObserver(draw);
  observer.observe(root);
  signal.addEventListener("abort", () => {
    observer.disconnect();
    window.Plotly?.purge(root);
  });
  redraw_on(model, ["traces", "frame"], draw);
  return root;
}
