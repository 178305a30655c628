// Says on the sketch of the page why it does not open; the page itself can not, as it is not there yet.
(() => {
  "use strict";
  const began = performance.now(), PATIENCE_MS = 15000, LOOK_MS = 200, FULL = 503;
  // the library tells nobody but itself that the connection has failed
  const look = () => {
    const sketch = document.getElementById("rj-first");
    if (!sketch) { return; }
    const lost = typeof Bokeh === "undefined" ? performance.now() - began > PATIENCE_MS : _wsError;
    if (lost) { ask(sketch.querySelector("p")); } else { setTimeout(look, LOOK_MS); }
  };
  // whether the server is gone, has no place, or could not make the page
  const ask = async (line) => {
    const status = await fetch(location.href, {cache: "no-store"}).then((answer) => answer.status, () => 0);
    if (status === FULL) { location.reload(); return; }
    line.textContent = status === 200
      ? "This page could not be opened; the server\u2019s log may say why. Reload it to try again."
      : "The server does not answer. Reload this page to try again.";
  };
  look();
})();
