// Says on the sketch of the page that the server does not answer; the page itself can not, as it is not there yet.
(() => {
  "use strict";
  const began = performance.now(), PATIENCE_MS = 15000, LOOK_MS = 200;
  // the library tells nobody but itself that the connection has failed
  const look = () => {
    const sketch = document.getElementById("rj-first");
    if (!sketch) { return; }
    const lost = typeof Bokeh === "undefined" ? performance.now() - began > PATIENCE_MS : _wsError;
    if (lost) {
      sketch.querySelector("p").textContent = "The server does not answer. Reload this page to try again.";
    } else { setTimeout(look, LOOK_MS); }
  };
  look();
})();
