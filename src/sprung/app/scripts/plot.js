// Curves over time in panels one above the other, drawn as the report draws its figures: the same classes, one unit is a pixel.

const LEFT = 62, RIGHT = 10, GAP = 10, BELOW = 38, TOP = 8;
const SVG = "http://www.w3.org/2000/svg";

export const inner = (width) => [LEFT, Math.max(width - LEFT - RIGHT, 50)];

export function element(kind, attributes, parent, text) {
  const made = document.createElementNS(SVG, kind);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  if (text !== undefined) made.textContent = text;
  parent?.append(made);
  return made;
}

// At most six round values between two, and how to write them.
export function roundTicks(low, high) {
  if (!(high > low)) return [];
  const power = 10 ** Math.floor(Math.log10((high - low) / 6));
  const step = [1, 2, 5, 10].map((size) => size * power).find((size) => (high - low) / size <= 6);
  const ticks = [];
  for (let k = Math.ceil(low / step - 1e-9); k <= high / step + 1e-9; k++) ticks.push([k * step, written(k * step, 7)]);
  return ticks;
}

export const written = (value, figures = 5) => (Number.isFinite(value) ? String(Number(value.toPrecision(figures))).replace("-", "−") : "–");

// Limits that enclose the numbers of all lines in sight.
function limits(lines, low, high) {
  let [least, most] = [Infinity, -Infinity];
  for (const { times, values, offset } of lines) {
    for (let i = 0; i < values.length; i++) {
      const time = times[i] + offset;
      if (values[i] === null || time < low || time > high) continue;
      if (values[i] < least) least = values[i];
      if (values[i] > most) most = values[i];
    }
  }
  if (!(least <= most)) return [-1, 1];
  const margin = 0.06 * (most - least) || 0.5 * Math.abs(most) || 1;
  return [least - margin, most + margin];
}

// `panels`: title and lines, each with times (s), values, offset (s), role and dashes. Returns the height of the picture.
export function drawPanels(svg, panels, low, high, width, tall) {
  const [left, across] = inner(width);
  const height = TOP + panels.length * (tall + GAP) + BELOW;
  svg.replaceChildren();
  svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
  svg.setAttribute("height", height);
  const place = (time) => left + ((time - low) / (high - low)) * across;
  panels.forEach((panel, number) => {
    const top = TOP + number * (tall + GAP);
    const [least, most] = limits(panel.lines, low, high);
    const clip = element("clipPath", { id: `panel-${number}` }, svg);
    element("rect", { x: left, y: top, width: across, height: tall }, clip);
    const ticks = roundTicks(least, most), every = Math.ceil((ticks.length * 13) / tall);
    ticks.filter((_, i) => i % every === 0).forEach(([value, text]) => {
      const y = top + tall * (1 - (value - least) / (most - least));
      element("path", { class: "grid", d: `M${left} ${y.toFixed(1)}h${across}` }, svg);
      element("text", { class: "tick", x: left - 5, y: (y + 3).toFixed(1), "text-anchor": "end" }, svg, text);
    });
    const group = element("g", { "clip-path": `url(#panel-${number})` }, svg);
    for (const line of panel.lines) {
      let d = "", down = false;
      line.values.forEach((value, i) => {
        if (value === null) { down = false; return; }
        const x = place(line.times[i] + line.offset), y = top + tall * (1 - (value - least) / (most - least));
        d += `${down ? "L" : "M"}${x.toFixed(1)} ${y.toFixed(1)}`;
        down = true;
      });
      element("path", { class: `curve ${line.role}`, d, "stroke-width": 1.3, ...(line.dashes ? { "stroke-dasharray": line.dashes } : {}) }, group);
    }
    element("path", { class: "frame", d: `M${left} ${top}v${tall}` }, svg);
    element("text", { class: "channel", x: left + across - 3, y: top + 12, "text-anchor": "end" }, svg, panel.title);
  });
  const bottom = TOP + panels.length * (tall + GAP) - GAP;
  element("path", { class: "frame", d: `M${left} ${bottom}h${across}` }, svg);
  for (const [value, text] of roundTicks(low, high)) {
    const x = place(value).toFixed(1);
    element("path", { class: "frame", d: `M${x} ${bottom}v4` }, svg);
    element("text", { class: "tick", x, y: bottom + 16, "text-anchor": "middle" }, svg, text);
  }
  element("text", { class: "label", x: left + across / 2, y: bottom + 33, "text-anchor": "middle" }, svg, "time in the picture, s");
  return { bottom, place };
}
