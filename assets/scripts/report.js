// What moves in a report: colours that follow the system, the slider over the optima, the copy of the figures on paper.
(async () => {
  "use strict";
  const read = (id) => JSON.parse(document.getElementById(id).textContent);
  const data = read("data"), figures = read("figures");
  const charts = Object.entries(data.charts);
  // a report without figures has no library to draw them
  if (data.draws) { await Bokeh.embed.embed_items(figures.docs, figures.items); }
  const bokeh = data.draws ? Bokeh.documents[Bokeh.documents.length - 1] : null;
  const model = (id) => bokeh.get_model_by_id(id);
  const view = (id) => Bokeh.index.find_one(model(id));
  const at = (id) => document.getElementById(id);

  // ---- colours

  const system = window.matchMedia("(prefers-color-scheme: dark)");
  const strip = data.charts.phases;
  let theme = "light";
  let phases = data.phases;
  const paint = (name) => {
    if (name === theme) return;
    theme = name;
    for (const [id, attribute, token] of data.worn) { model(id).setv({[attribute]: data.tokens[theme][token]}); }
    for (const [id, column, light, dark] of data.columns) {
      // drawn anew below
      if (id === strip?.sources.phases) continue;
      const source = model(id);
      source.data = {...source.data, [column]: theme === "dark" ? dark : light};
    }
    placeNames();
    drawPhases();
  };
  const follow = () => {
    if (!document.documentElement.classList.contains("prints")) { paint(system.matches ? "dark" : "light"); }
  };

  // ---- phases, with as many words as have room

  const bands = strip && model(strip.sources.phases);
  const drawPhases = () => {
    if (!strip) return;
    const frame = view(strip.figure);
    const range = model(strip.figure).x_range;
    const scale = frame ? frame.frame.bbox.width / (range.end - range.start) : 0.5;
    const columns = {left: [], right: [], middle: [], text: [], fill: [], ink: []};
    phases.forEach(([name, start, end, speed], k) => {
      const room = (end - start) * scale;
      const all = `${k + 1}  ${data.words[name]}` + (name === "hold" ? ` ${speed}` : "");
      columns.left.push(start);
      columns.right.push(end);
      columns.middle.push((start + end) / 2);
      columns.text.push(all.length * 7.2 < room ? all : room > 12 ? String(k + 1) : "");
      columns.fill.push(data.tokens[theme][name]);
      columns.ink.push(data.tokens[theme]["on_" + name]);
    });
    bands.data = columns;
  };

  // ---- room for the names at the ends of lines; where there is none, they go

  const NARROW_PX = 480, NAME_PX = 112;
  const fitNames = () => {
    if (!strip) return;
    const frame = view(strip.figure)?.frame.bbox.width ?? 0;
    if (frame <= 0) return;
    const wide = frame >= NARROW_PX;
    for (const id of data.spare) { model(id).visible = wide; }
    const range = model(strip.figure).x_range;
    const whole = Math.abs(range.end - range.reset_end) < 1e-6 && Math.abs(range.start) < 1e-6;
    const end = data.distance * (wide ? frame / (frame - NAME_PX) : 1);
    if (Math.abs(end - range.reset_end) < 1e-6 * end) return;
    range.setv({bounds: [0, end], reset_end: end});
    if (whole) { range.setv({start: 0, end}); }
  };

  // ---- the travel time

  const runs = data.optima.runs;
  const slider = at("time"), back = at("back"), shown = document.querySelector("output[for=time]");
  const own = data.optima.own;
  const first = new Map();
  const keep = (id) => { if (!first.has(id)) first.set(id, {...model(id).data}); return first.get(id); };
  const fit = (chart) => {
    const ends = chart.lines.map(([id, column]) => model(id).data[column]).filter((y) => y.length);
    const low = Math.min(...ends.map((y) => y.reduce((a, b) => Math.min(a, b), Infinity)));
    const high = Math.max(...ends.map((y) => y.reduce((a, b) => Math.max(a, b), -Infinity)));
    const room = chart.room * Math.max(high - low, 1e-9);
    model(chart.range).setv({start: low - room, end: high + room});
  };
  const move = () => {
    const k = Number(slider.value), run = runs[k];
    shown.textContent = run.time;
    slider.setAttribute("aria-valuetext", run.time);
    at("shown").textContent = run.shown;
    at("numbers").innerHTML = run.numbers;
    at("advice").innerHTML = run.advice;
    // these belong to a section that a report may lack
    if (at("account")) { at("account").innerHTML = run.account; }
    if (at("phases")) { at("phases").innerHTML = run.table; }
    const {largest, ...columns} = run.lines;
    // at its own place of the slider a run has no lines of its own here: the figures show theirs again
    const draw = (id, moved) => { const start = keep(id); model(id).data = moved ? {...start, ...moved} : start; };
    draw(data.optimum, columns.speed && columns);
    for (const [name, chart] of charts) {
      if (chart.sources.largest) { draw(chart.sources.largest, largest && {x: columns.position, y: largest}); }
      if (chart.sources.borders && name !== "line") {
        model(chart.sources.borders).data = {x: run.phases.slice(0, -1).map((phase) => phase[2])};
      }
      if (chart.fits) fit(chart);
    }
    placed = run.names;
    placeNames();
    phases = run.phases;
    drawPhases();
    if (data.charts.frontier) {
      model(data.charts.frontier.sources.point).data = {x: [run.point[0]], y: [run.point[1]]};
    }
  };
  // the report knows for each run where the names have room
  let placed = null;
  const placeNames = () => {
    for (const [name, columns] of Object.entries(placed ?? {})) {
      const source = model(data.charts[name].sources[data.charts[name].names]);
      source.data = {...columns, colour: columns.line.map((line) => data.tokens[theme][line])};
    }
  };
  if (slider) {
    slider.addEventListener("input", move);
    back.addEventListener("click", () => { slider.value = own; move(); });
  }

  // ---- paper: always light, as wide as a page, copied into plain canvases that print as they are

  const PAPER_PX = 760;
  const settle = () => {
    for (const root of data.draws ? Object.values(Bokeh.index) : []) { root.after_resize?.(); }
    for (const [, chart] of charts) {
      const figure = view(chart.figure);
      figure.canvas_view?.after_resize?.();
      figure.paint();
    }
  };
  const prepare = () => {
    document.documentElement.classList.add("prints");
    document.querySelector("main").style.width = `${PAPER_PX}px`;
    settle();
    fitNames();
    if (theme === "light") { drawPhases(); } else { paint("light"); }
  };
  const copy = () => {
    settle();
    for (const [name, chart] of charts) {
      const image = view(chart.figure).export("png").canvas;
      const canvas = document.querySelector(`[data-plot="${name}"] .paper canvas`);
      canvas.width = image.width;
      canvas.height = image.height;
      canvas.getContext("2d").drawImage(image, 0, 0);
    }
    document.documentElement.classList.add("on-paper");
    document.querySelector("main").style.width = "";
  };
  // two listeners, as what the first one changes is drawn in the microtasks between them
  window.addEventListener("beforeprint", prepare);
  window.addEventListener("beforeprint", copy);
  window.addEventListener("afterprint", () => {
    document.documentElement.classList.remove("on-paper", "prints");
    settle();
    follow();
    arrange();
  });

  // ---- what depends on the width: the names, the words in the phases, tables that must be scrolled

  const arrange = () => {
    fitNames();
    drawPhases();
    for (const block of document.querySelectorAll(".block")) {
      if (block.scrollWidth > block.clientWidth) { block.tabIndex = 0; } else { block.removeAttribute("tabindex"); }
    }
  };
  system.addEventListener("change", follow);
  window.addEventListener("resize", () => requestAnimationFrame(arrange));
  follow();
  arrange();
  document.documentElement.classList.add("ready");
})();
