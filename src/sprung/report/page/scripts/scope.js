// Zoom, cursor and switches of one figure: its curves are drawn again from all samples that are in sight.

const SAMPLES = 800; // of a curve that are drawn: nobody sees more
const WIDTH = 440; // units across a drawing

function scopeOf(figure, svg, held, columns) {
  const groups = [...svg.querySelectorAll("g.panel")];
  const across = svg.querySelector("g.across");
  const height = Number(svg.getAttribute("viewBox").split(" ")[3]);
  const whole = [held.x.low, held.x.high];
  const axes = held.panels.map((panel) => ({ ...panel.y }));
  const x = { ...held.x };
  const hidden = new Set();
  const [left, , width] = held.panels[0].box;
  const [, lastTop, , lastHeight] = held.panels.at(-1).box;
  const bottom = lastTop + lastHeight;
  const spoken = element("p", { class: "spoken", "aria-live": "polite" }, figure);
  let cursor = null, fitted = false;

  svg.setAttribute("tabindex", "0");
  svg.setAttribute("role", "group");
  svg.setAttribute("aria-label", `${held.title}. Arrow keys move the cursor, plus and minus zoom, 0 shows the whole range.`);

  const shows = ({ panel, curve }) => !hidden.has(panel.channel) && !hidden.has(curve.name);
  const place = (value) => left + width * along(x, value);

  // Only every so many samples of a long stretch are drawn: the lowest and the highest of each.
  function path(xs, ys, panel, axis) {
    const [, top, , tall] = panel.box;
    let first = 0, last = xs.length - 1;
    while (first < last && xs[first + 1] < x.low) first++;
    while (last > first && xs[last - 1] > x.high) last--;
    const every = Math.max(1, Math.floor((last - first + 1) / (SAMPLES / 2)));
    const chosen = [];
    for (let i = first; i <= last; i += every) {
      let low = i, high = i;
      for (let j = i; j < Math.min(i + every, last + 1); j++) {
        if (ys[j] < ys[low] || Number.isNaN(ys[low])) low = j;
        if (ys[j] > ys[high] || Number.isNaN(ys[high])) high = j;
      }
      chosen.push(...(low === high ? [low] : [Math.min(low, high), Math.max(low, high)]));
    }
    let steps = "", down = false;
    chosen.forEach((i) => {
      // The outermost samples lie beyond the ends: the line to them ends where the panel does.
      let px = xs[i], py = ys[i];
      const inner = i === first ? i + 1 : i === last ? i - 1 : i;
      const end = Math.min(Math.max(px, x.low), x.high);
      if (end !== px && inner !== i) { py += (ys[inner] - py) * (end - px) / (xs[inner] - px); px = end; }
      const y = Math.min(Math.max(top + tall * (1 - along(axis, py)), top - 4), top + tall + 4);
      if (Number.isFinite(y)) steps += `${down ? "L" : "M"}${(10 * place(px)).toFixed(0)} ${(10 * y).toFixed(0)}`;
      down = Number.isFinite(y);
    });
    return steps;
  }

  function ticksAcross() {
    across.querySelectorAll(".tick, .frame ~ .frame").forEach((one) => one.remove());
    for (const [value, text] of roundTicks(x.low, x.high)) {
      element("path", { class: "frame", d: `M${place(value).toFixed(1)} ${bottom}v3` }, across);
      element("text", { class: "tick", x: place(value).toFixed(1), y: bottom + 13, "text-anchor": "middle", text }, across);
    }
  }

  function ticksDown(panel, axis, group) {
    const [, top, , tall] = panel.box;
    const ticks = roundTicks(axis.low, axis.high);
    const every = Math.ceil(ticks.length * 11 / tall); // as many as have room below each other
    group.replaceChildren();
    for (const [value, text] of ticks.filter((_, i) => i % every === 0)) {
      const y = top + tall * (1 - along(axis, value));
      element("path", { class: "grid", d: `M${left} ${y.toFixed(1)}h${width}` }, group);
      if (panel.lane && (y < top + 4.5 || y > top + tall - 4.5)) continue;
      element("text", { class: "tick", x: left - 4, y: (y + 3).toFixed(1), "text-anchor": "end", text }, group);
    }
  }

  function fitHeights(data) {
    held.panels.forEach((panel, i) => {
      let low = Infinity, high = -Infinity;
      for (const curve of panel.curves) {
        columnsInside(data[curve.x], (j) => {
          const value = data[curve.y][j];
          if (value < low) low = value;
          if (value > high) high = value;
        });
      }
      const margin = 0.06 * (high - low) || 1e-9;
      axes[i] = fitted && low <= high ? { ...panel.y, low: low - margin, high: high + margin } : { ...panel.y };
    });
  }

  function columnsInside(xs, act) {
    for (let i = 0; i < xs.length; i++) if (xs[i] >= x.low && xs[i] <= x.high) act(i);
  }

  async function draw() {
    const data = await columns();
    fitHeights(data);
    held.panels.forEach((panel, i) => {
      const [, top, , tall] = panel.box;
      ticksDown(panel, axes[i], groups[i].querySelector(".ticks"));
      for (const one of groups[i].querySelectorAll("[data-curve]")) {
        const curve = panel.curves[one.dataset.curve];
        const [xs, ys] = [data[curve.x], data[curve.y]];
        one.style.display = hidden.has(curve.name) ? "none" : "";
        if (!curve.points) one.setAttribute("d", path(xs, ys, panel, axes[i]) || "M0 0");
        else {
          let dots = "";
          columnsInside(xs, (j) => { dots += `M${place(xs[j]).toFixed(1)} ${(top + tall * (1 - along(axes[i], ys[j]))).toFixed(1)}h0`; });
          one.setAttribute("d", dots || "M0 0");
        }
      }
      for (const rule of groups[i].querySelectorAll("path[data-x]")) {
        const at = place(Number(rule.dataset.x));
        rule.setAttribute("d", at >= left && at <= left + width ? `M${at.toFixed(1)} ${top}v${tall}` : "M0 0");
      }
      for (const rule of groups[i].querySelectorAll("path.rule:not([data-x])")) {
        const y = top + tall * (1 - along(axes[i], 0));
        rule.setAttribute("d", y >= top && y <= top + tall ? `M${left} ${y.toFixed(1)}h${width}` : "M0 0");
      }
      for (const band of groups[i].querySelectorAll(".band")) {
        const ends = [band.dataset.low, band.dataset.high].map((end) => Math.min(Math.max(place(Number(end)), left), left + width));
        band.setAttribute("x", Math.min(...ends).toFixed(1));
        band.setAttribute("width", Math.abs(ends[1] - ends[0]).toFixed(1));
      }
    });
    for (const label of svg.querySelectorAll(":scope > [data-x]")) {
      const at = place(Number(label.dataset.x));
      label.style.display = at >= left && at <= left + width ? "" : "none";
      if (label.tagName === "text") label.setAttribute("x", at.toFixed(1));
      else label.setAttribute("d", label.getAttribute("d").replace(/^M[\d.]+/, `M${at.toFixed(1)}`));
    }
    ticksAcross();
    point(data);
  }

  // The cursor: a line through every panel, the values beside it, and the same in words for who cannot see them.
  function point(data) {
    svg.querySelectorAll(".cursor, .reading").forEach((one) => one.remove());
    if (cursor === null) { spoken.textContent = ""; return; }
    const time = data[held.panels[0].curves[0].x][cursor];
    const words = [`${written(time, 6)} ${held.x.label.split(", ").at(-1)}`];
    held.panels.forEach((panel, i) => {
      if (hidden.has(panel.channel)) return;
      const [, top, , tall] = panel.box;
      element("path", { class: "cursor", d: `M${place(time).toFixed(1)} ${top}v${tall}` }, groups[i]);
      const lines = panel.curves.filter((curve) => !curve.points && !hidden.has(curve.name));
      const texts = lines.map((curve) => [curve.name, written(data[curve.y][nearest(data[curve.x], time)], 4)].filter(Boolean).join(" "));
      element("text", { class: "reading", x: left + 4, y: top + 10, text: texts.join(" · ") }, groups[i]);
      words.push(`${panel.name}: ${texts.join(", ")}`);
    });
    const middle = Math.min(Math.max(place(time), left + 20), left + width - 20).toFixed(1);
    element("text", { class: "reading", x: middle, y: bottom - 3, "text-anchor": "middle", text: words[0] }, across);
    spoken.textContent = words.join("; ");
  }

  async function moveTo(value) {
    const data = await columns();
    const xs = data[held.panels[0].curves[0].x];
    const old = cursor;
    cursor = nearest(xs, value);
    if (old !== cursor) point(data);
  }

  async function range(low, high) {
    const xs = (await columns())[held.panels[0].curves[0].x];
    const least = 8 * (xs.at(-1) - xs[0]) / xs.length; // a few samples stay in sight
    const span = Math.min(Math.max(high - low, least), whole[1] - whole[0]);
    x.low = Math.min(Math.max((low + high - span) / 2, whole[0]), whole[1] - span);
    x.high = x.low + span;
    await draw();
  }

  async function zoom(by) {
    const xs = (await columns())[held.panels[0].curves[0].x];
    const at = cursor === null || xs[cursor] < x.low || xs[cursor] > x.high ? (x.low + x.high) / 2 : xs[cursor];
    await range(at - by * (at - x.low), at + by * (x.high - at));
  }

  async function step(by) {
    const xs = (await columns())[held.panels[0].curves[0].x];
    const seen = xs.filter((value) => value >= x.low && value <= x.high).length;
    const from = cursor ?? nearest(xs, (x.low + x.high) / 2);
    cursor = Math.min(Math.max(from + Math.sign(by) * Math.max(1, Math.round(Math.abs(by) * seen)), 0), xs.length - 1);
    const past = Math.max(xs[cursor] - x.high, 0) + Math.min(xs[cursor] - x.low, 0);
    await range(x.low + past, x.high + past);
  }

  const reset = () => { fitted = false; return range(...whole); };
  const fit = () => { fitted = !fitted; return draw(); };

  const keys = {
    ArrowRight: (fast) => step(fast ? 0.1 : 0.004), ArrowLeft: (fast) => step(fast ? -0.1 : -0.004),
    "+": () => zoom(0.5), "=": () => zoom(0.5), "-": () => zoom(2), 0: reset, f: fit,
    Home: () => range(whole[0], whole[0] + x.high - x.low), End: () => range(whole[1] - x.high + x.low, whole[1]),
    Escape: async () => { cursor = null; point(await columns()); },
  };
  svg.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || !(event.key in keys)) return;
    event.preventDefault();
    keys[event.key](event.shiftKey);
  });

  // A pull across the panels zooms to what it spans.
  const unitOf = (event) => (event.clientX - svg.getBoundingClientRect().left) * WIDTH / svg.getBoundingClientRect().width;
  const partOf = (unit) => Math.min(Math.max((unit - left) / width, 0), 1);
  let pulled = null;
  svg.addEventListener("pointerdown", (event) => {
    if (event.button) return;
    pulled = { from: unitOf(event), box: element("rect", { class: "pull", y: 0, height, x: 0, width: 0 }, svg) };
    svg.setPointerCapture(event.pointerId);
  });
  svg.addEventListener("pointermove", (event) => {
    const unit = unitOf(event);
    if (pulled) {
      pulled.box.setAttribute("x", Math.min(pulled.from, unit));
      pulled.box.setAttribute("width", Math.abs(unit - pulled.from));
    }
    moveTo(valueAt(x, partOf(unit)));
  });
  const finish = (event) => {
    if (!pulled) return;
    const ends = [pulled.from, unitOf(event)].sort((one, other) => one - other);
    pulled.box.remove();
    pulled = null;
    if (event.type === "pointerup" && ends[1] - ends[0] > 8) range(...ends.map((unit) => valueAt(x, partOf(unit))));
  };
  svg.addEventListener("pointerup", finish);
  svg.addEventListener("pointercancel", finish);
  svg.addEventListener("pointerleave", async () => {
    if (document.activeElement === svg || pulled) return;
    cursor = null;
    if (svg.querySelector(".cursor")) point(await columns());
  });
  svg.addEventListener("dblclick", reset);

  // Panels that are switched off leave their room to those below.
  function arrange() {
    let shift = 0;
    held.panels.forEach((panel, i) => {
      const next = held.panels[i + 1]?.box[1] ?? panel.box[1] + panel.box[3];
      groups[i].style.display = hidden.has(panel.channel) ? "none" : "";
      groups[i].setAttribute("transform", `translate(0 ${-shift})`);
      if (hidden.has(panel.channel)) shift += next - panel.box[1];
    });
    across.setAttribute("transform", `translate(0 ${-shift})`);
    svg.setAttribute("viewBox", `0 0 ${WIDTH} ${Math.round(height - shift)}`);
  }

  function switches(tools) {
    const named = [...held.panels.map((panel) => panel.channel), ...held.panels.flatMap((panel) => panel.curves.map((curve) => curve.name))];
    const box = element("details", { class: "switches" }, tools);
    element("summary", { text: "Channels" }, box);
    for (const name of new Set(named.filter(Boolean))) {
      const label = element("label", {}, box);
      const check = element("input", { type: "checkbox" }, label);
      check.checked = true;
      label.append(` ${name}`);
      check.addEventListener("change", () => {
        if (check.checked) hidden.delete(name); else hidden.add(name);
        arrange();
        draw();
      });
    }
  }

  return { zoom, reset, fit, switches, shows, range: () => [x.low, x.high] };
}
