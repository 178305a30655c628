// The moving parts of a report: colours that follow the system, the slider over the optima, copies of figures on paper.
(async () => {
  "use strict";
  const at = (id) => document.getElementById(id), read = (id, revive) => JSON.parse(at(id).textContent, revive);
  // JSON has no NaN
  const data = read("data", (_, value) => value ?? NaN), embedding = read("figures"), ids = Object.values(data.figures);
  // a report without figures has no library to draw them
  if (ids.length) { await Bokeh.embed.embed_items(embedding.docs, embedding.items); }
  const bokeh = ids.length ? Bokeh.documents.at(-1) : null;
  const model = (id) => bokeh.get_model_by_id(id), view = (id) => Bokeh.index.find_one(model(id));
  const system = window.matchMedia("(prefers-color-scheme: dark)"), root = document.documentElement.classList;
  let theme = "light", optimum = null;

  // ---- columns: those of the file, with names of colours, or those of another optimum

  const moving = new Set([...Object.keys(data.colours), ...data.optima.flatMap(({sources}) => Object.keys(sources))]);
  const own = new Map([...moving].map((id) => [id, {...model(id).data, ...data.colours[id]}]));
  const LETTER_PX = 7.2, NARROW_PX = 480, NAME_PX = 112;
  const frame_px = () => view(data.figures.phases)?.frame.bbox.width ?? 0;
  const show = (id) => {
    const columns = {...own.get(id), ...optimum?.sources[id]};
    for (const name of ["colour", "fill", "ink"].filter((one) => one in columns)) {
      columns[name] = columns[name].map((token) => data.tokens[theme][token]);
    }
    if (id === data.phases) {
      const {x_range: {start, end}} = model(data.figures.phases), {left, right} = columns;
      columns.text = columns.text.map((text, k) => {
        const room = (right[k] - left[k]) / (end - start) * frame_px();
        return text.length * LETTER_PX < room ? text : room > 12 ? text.split(" ")[0] : "";
      });
    }
    model(id).data = columns;
  };
  const follow = () => {
    const before = theme;
    theme = system.matches && !root.contains("prints") ? "dark" : "light";
    const worn = theme === before ? [] : data.worn;
    for (const [id, attribute, token] of worn) { model(id).setv({[attribute]: data.tokens[theme][token]}); }
    moving.forEach(show);
  };

  // ---- the travel time

  const slider = at("time"), move = () => {
    optimum = data.optima[slider.value];
    slider.nextElementSibling.textContent = optimum.time;
    slider.setAttribute("aria-valuetext", optimum.time);
    // some places belong to sections that a report may lack
    for (const [id, text] of Object.entries(optimum.texts)) { if (at(id)) { at(id).innerHTML = text; } }
    moving.forEach(show);
    for (const [id, [start, end]] of Object.entries(optimum.ends)) { model(id).setv({start, end}); }
  };
  slider?.addEventListener("input", move);
  at("back")?.addEventListener("click", () => { slider.value = data.own; move(); });

  // ---- the width: room for names at the ends of lines, words of the phases, tables that must be scrolled

  const arrange = () => {
    if (data.phases && frame_px() > 0) {
      const wide = frame_px() >= NARROW_PX, range = model(data.figures.phases).x_range;
      const whole = Math.abs(range.end - range.reset_end) < 1e-6 && Math.abs(range.start) < 1e-6;
      const end = data.distance * (wide ? frame_px() / (frame_px() - NAME_PX) : 1);
      for (const id of data.spare) { model(id).visible = wide; }
      range.setv({bounds: [0, end], reset_end: end, ...(whole ? {start: 0, end} : {})});
      show(data.phases);
    }
    for (const block of document.querySelectorAll(".block")) {
      if (block.scrollWidth > block.clientWidth) { block.tabIndex = 0; } else { block.removeAttribute("tabindex"); }
    }
  };

  // ---- paper: always light, as wide as a page, copied into plain canvases that print as they are

  const PAPER = "760px", main = document.querySelector("main");
  const settle = () => {
    for (const one of ids.length ? Object.values(Bokeh.index) : []) { one.after_resize?.(); }
    for (const id of ids) { view(id).canvas_view?.after_resize?.(); view(id).paint(); }
  };
  const follow_all = () => { settle(); arrange(); follow(); };
  // two listeners, as the changes of the first one are drawn in the microtasks between them
  window.addEventListener("beforeprint", () => {
    root.add("prints");
    main.style.width = PAPER;
    follow_all();
  });
  window.addEventListener("beforeprint", () => {
    settle();
    for (const [name, id] of Object.entries(data.figures)) {
      const {canvas: image} = view(id).export("png"), copy = document.querySelector(`[data-plot="${name}"] .paper canvas`);
      Object.assign(copy, {width: image.width, height: image.height}).getContext("2d").drawImage(image, 0, 0);
    }
    root.add("on-paper");
    main.style.width = "";
  });
  window.addEventListener("afterprint", () => { root.remove("on-paper", "prints"); follow_all(); });
  system.addEventListener("change", follow);
  window.addEventListener("resize", () => requestAnimationFrame(arrange));
  follow_all();
  root.add("ready");
})();
