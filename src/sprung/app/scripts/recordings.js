// Recordings side by side: which files and channels are shown, from when to when, and with which offset of each clock.
import { drawPanels, element, inner, written } from "/scripts/plot.js";

const field = (name) => document.querySelector(`#${name}`);
const svg = field("plot");
const ROLES = ["simulated", "residual", "mode", "second", "signal", "release"];
const DASHES = ["", "7 3", "2 3"];
const PANEL = 130;
const BATCH = 10; // files whose channels are asked for at once
const known = new Map(); // by file: channels, begin and end, or a problem
const chosen = new Map(); // by file: offset in s, and samples by channel
const shown = new Set(); // names of channels
const announce = (text) => { document.querySelector("#announcements").textContent = text; };
let view = null, cursor = null, waiting = 0, aborter = null;

const boxes = () => [...document.querySelectorAll("#files input[type=checkbox]")];
const files = () => [...chosen.keys()];
const hasChannel = (file, channel) => known.get(file)?.channels?.some(({ name }) => name === channel);

async function fetchJson(address, options = {}) {
  const answer = await fetch(address, { headers: { Accept: "application/json" }, ...options });
  if (!answer.ok) throw new Error((await answer.text()).trim());
  return answer.json();
}

async function learn(names) {
  const missing = names.filter((name) => !known.has(name));
  for (let i = 0; i < missing.length; i += BATCH) {
    const part = missing.slice(i, i + BATCH);
    if (missing.length > BATCH) field("found").textContent = `${i} of ${missing.length} recordings read`;
    const found = await fetchJson(`/recordings/channels?${new URLSearchParams(part.map((name) => ["file", name]))}`);
    found.forEach((one) => known.set(one.file, one));
  }
}

// The range of everything that is chosen, in the time of the picture.
function whole() {
  const spans = files().filter((file) => known.get(file)?.channels).map((file) => [known.get(file).begin, known.get(file).end].map((time) => time + chosen.get(file).offset));
  if (!spans.length) return [0, 1];
  const [low, high] = [Math.min(...spans.map(([a]) => a)), Math.max(...spans.map(([, b]) => b))];
  return high > low ? [low, high] : [low, low + 1];
}

function panels() {
  return [...shown].map((channel) => {
    const own = files().filter((file) => hasChannel(file, channel));
    const unit = own.map((file) => known.get(file).channels.find(({ name }) => name === channel).unit).find(Boolean);
    const lines = own.flatMap((file) => {
      const samples = chosen.get(file).samples.get(channel), number = files().indexOf(file);
      return samples ? [{ file, times: samples.time, values: samples.values, offset: chosen.get(file).offset, ...style(number) }] : [];
    });
    return { channel, title: unit ? `${channel}, ${unit}` : channel, lines };
  }).filter(({ channel }) => files().some((file) => hasChannel(file, channel)));
}

const style = (number) => ({ role: ROLES[number % ROLES.length], dashes: DASHES[Math.floor(number / ROLES.length) % DASHES.length] });

function draw() {
  const drawn = panels();
  field("plot-area").hidden = !drawn.length;
  field("nothing").hidden = drawn.length > 0;
  if (!drawn.length) return;
  const [low, high] = view ?? whole(), width = Math.max(svg.parentElement.clientWidth, 280);
  const { bottom, place } = drawPanels(svg, drawn, low, high, width, PANEL);
  svg.setAttribute("aria-label", `${drawn.map(({ title }) => title).join("; ")}, from ${written(low)} to ${written(high)} s. Plus and minus zoom, arrows move, shift and arrows move the cursor, 0 shows everything.`);
  if (cursor !== null && cursor >= low && cursor <= high) {
    element("path", { class: "cursor", d: `M${place(cursor).toFixed(1)} 8V${bottom}` }, svg);
    field("reading").textContent = reading(drawn);
  } else {
    field("reading").textContent = `${written(low)} to ${written(high)} s`;
  }
  field("visible").value = JSON.stringify({
    low, high,
    parts: files().map((file) => ({ file, offset: chosen.get(file).offset, channels: [...shown].filter((channel) => hasChannel(file, channel)) })).filter(({ channels }) => channels.length),
  });
}

function reading(drawn) {
  const at = ({ times, values, offset }) => {
    let [low, high] = [0, times.length - 1];
    while (high - low > 1) { const middle = (low + high) >> 1; if (times[middle] + offset <= cursor) low = middle; else high = middle; }
    return cursor - times[low] - offset < times[high] + offset - cursor ? values[low] : values[high];
  };
  return [`${cursor.toFixed(4)} s`, ...drawn.map(({ title, lines }) => `${title}: ${lines.filter(({ times }) => times.length).map((line) => written(at(line) ?? NaN)).join(" / ")}`)].join("; ");
}

// What is in sight is asked for anew; until it is here, what was known of it is drawn.
async function ask() {
  aborter?.abort();
  aborter = new AbortController();
  const { signal } = aborter, [low, high] = view ?? whole(), [, pixels] = inner(svg.parentElement.clientWidth);
  field("refusal").textContent = "";
  try {
    for (const file of files()) {
      const own = [...shown].filter((channel) => hasChannel(file, channel)), entry = chosen.get(file);
      if (!own.length) continue;
      const query = new URLSearchParams([["file", file], ["low", low - entry.offset], ["high", high - entry.offset], ["pixels", Math.round(pixels)], ...own.map((channel) => ["channel", channel])]);
      let found = await fetchJson(`/recordings/visible?${query}`, { signal });
      while (found.done !== undefined) {
        field("state").textContent = `${file} is being read: ${Math.round(100 * found.done)} %`;
        found = await fetchJson(`/recordings/visible?${query}`, { signal });
      }
      for (const [channel, samples] of Object.entries(found.channels)) entry.samples.set(channel, samples);
      draw();
    }
    field("state").textContent = "";
    svg.dataset.ready = `${low} ${high}`;
  } catch (error) {
    if (error.name === "AbortError") return;
    field("refusal").textContent = error.message;
    field("state").textContent = "";
  }
}

function change(low, high) {
  const [first, last] = whole();
  const least = (last - first) * 1e-7;
  view = high - low < least ? view : [low, high];
  if (low <= first && high >= last) view = null;
  draw();
  remember();
  clearTimeout(waiting);
  waiting = setTimeout(ask, 80);
}

const zoom = (factor, about) => {
  const [low, high] = view ?? whole(), middle = about ?? cursor ?? (low + high) / 2;
  change(middle - (middle - low) * factor, middle + (high - middle) * factor);
};
const move = (part) => { const [low, high] = view ?? whole(), step = part * (high - low); change(low + step, high + step); };
function moveCursor(part) {
  const [low, high] = view ?? whole();
  cursor = Math.min(Math.max((cursor ?? (low + high) / 2) + part * (high - low), low), high);
  draw();
  announce(field("reading").textContent);
}

// The address holds what is shown, so that a reload, or a second tab, shows it too.
function remember() {
  const query = new URLSearchParams();
  for (const [file, { offset }] of chosen) { query.append("file", file); query.append("offset", offset); }
  for (const channel of shown) query.append("channel", channel);
  if (view) { query.set("low", view[0]); query.set("high", view[1]); }
  history.replaceState(null, "", `/recordings?${query}`);
}

function lists() {
  const list = field("chosen");
  list.replaceChildren(...files().map((file, number) => {
    const item = document.createElement("li"), entry = chosen.get(file), { role, dashes } = style(number);
    const sample = element("svg", { class: "picture key", viewBox: "0 0 28 10", "aria-hidden": "true" }, item);
    element("path", { class: `curve ${role}`, d: "M1 5H27", "stroke-width": 2, ...(dashes ? { "stroke-dasharray": dashes } : {}) }, sample);
    const label = Object.assign(document.createElement("label"), { textContent: `${file} `, htmlFor: `offset-${number}` });
    const input = Object.assign(document.createElement("input"), { id: `offset-${number}`, inputMode: "decimal", value: entry.offset, size: 7 });
    input.setAttribute("aria-label", `Time offset of ${file} in s`);
    input.addEventListener("change", () => {
      const value = Number(input.value.trim().replace(",", ".") || 0);
      input.setAttribute("aria-invalid", String(!Number.isFinite(value)));
      if (!Number.isFinite(value)) { announce("The offset is a number of seconds, such as 0.25 or 0,25."); return; }
      entry.offset = value;
      draw();
      remember();
      ask();
    });
    const problem = known.get(file)?.problem;
    item.append(label, "offset ", input, " s");
    if (problem) item.append(Object.assign(document.createElement("p"), { className: "problem", textContent: problem }));
    return item;
  }));
  const names = [...new Set(files().flatMap((file) => known.get(file)?.channels?.map(({ name }) => name) ?? []))];
  field("channels").replaceChildren(...names.map((name) => {
    const label = document.createElement("label"), box = Object.assign(document.createElement("input"), { type: "checkbox", checked: shown.has(name) });
    label.dataset.name = name.toLowerCase();
    box.addEventListener("change", () => { box.checked ? shown.add(name) : shown.delete(name); draw(); remember(); ask(); });
    label.append(box, name);
    return label;
  }));
  filter();
}

async function toggle(file, on) {
  if (on) chosen.set(file, chosen.get(file) ?? { offset: 0, samples: new Map() });
  else chosen.delete(file);
  field("opening").textContent = on && !known.has(file) ? `${file} is being opened` : "";
  try {
    await learn([file]);
  } catch (error) {
    field("refusal").textContent = error.message;
    return;
  } finally {
    field("opening").textContent = "";
  }
  const names = files().flatMap((name) => known.get(name)?.channels?.map((channel) => channel.name) ?? []);
  if (!names.some((name) => shown.has(name)) && names.length) shown.add(names[0]);
  lists();
  draw();
  remember();
  ask();
}

// Files whose name, or one of whose channels as far as they are known, contains the text.
function filter() {
  const text = field("search").value.trim().toLowerCase();
  let count = 0;
  for (const box of boxes()) {
    const channels = known.get(box.value)?.channels ?? [];
    const hits = text ? channels.filter(({ name }) => name.toLowerCase().includes(text)).map(({ name }) => name) : [];
    const fits = box.value.toLowerCase().includes(text) || hits.length > 0;
    const item = box.closest("li");
    item.hidden = !fits;
    item.querySelector(".hits").textContent = hits.length ? ` ${hits.slice(0, 6).join(", ")}${hits.length > 6 ? " …" : ""}` : "";
    count += fits;
  }
  document.querySelectorAll("#channels label").forEach((label) => { label.hidden = Boolean(text) && ![...boxes()].some((box) => box.value.toLowerCase().includes(text)) && !label.dataset.name.includes(text); });
  document.querySelectorAll("#files details").forEach((one) => {
    const some = [...one.querySelectorAll("li")].some((item) => !item.hidden);
    one.hidden = !some;
    if (text && some) one.open = true;
  });
  const read = boxes().filter((box) => known.has(box.value)).length;
  field("found").textContent = text ? `${count} of ${boxes().length} recordings; channels of ${read} are known` : "";
}

function listen() {
  boxes().forEach((box) => box.addEventListener("change", () => toggle(box.value, box.checked)));
  field("search").addEventListener("input", filter);
  field("search-all").addEventListener("click", async () => {
    field("search-all").disabled = true;
    try { await learn(boxes().map((box) => box.value)); } catch (error) { field("refusal").textContent = error.message; }
    field("search-all").disabled = false;
    filter();
  });
  const actions = { in: () => zoom(0.5), out: () => zoom(2), left: () => move(-0.25), right: () => move(0.25), whole: () => { view = null; change(...whole()); } };
  document.querySelectorAll("[data-zoom]").forEach((button) => button.addEventListener("click", actions[button.dataset.zoom]));
  svg.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const keys = {
      "+": actions.in, "-": actions.out, 0: actions.whole,
      ArrowLeft: () => (event.shiftKey ? moveCursor(-0.01) : move(-0.1)), ArrowRight: () => (event.shiftKey ? moveCursor(0.01) : move(0.1)),
    };
    if (!keys[event.key]) return;
    event.preventDefault();
    keys[event.key]();
  });
  const timeAt = (event) => {
    const box = svg.getBoundingClientRect(), [left, across] = inner(box.width), [low, high] = view ?? whole();
    return low + Math.min(Math.max((event.clientX - box.left - left) / across, 0), 1) * (high - low);
  };
  let held = null;
  svg.addEventListener("pointerdown", (event) => { held = timeAt(event); svg.setPointerCapture(event.pointerId); });
  svg.addEventListener("pointermove", (event) => {
    cursor = timeAt(event);
    draw();
    if (held === null) return;
    const [low, high] = view ?? whole(), [left, across] = inner(svg.getBoundingClientRect().width);
    const [a, b] = [held, cursor].sort((one, other) => one - other).map((time) => left + ((time - low) / (high - low)) * across);
    element("rect", { class: "pull", x: a, y: 8, width: b - a, height: svg.viewBox.baseVal.height - 46 }, svg);
  });
  svg.addEventListener("pointerup", (event) => {
    const [low, high] = view ?? whole(), ends = [held ?? 0, timeAt(event)].sort((one, other) => one - other);
    const pulled = held !== null && ends[1] - ends[0] > 0.01 * (high - low);
    held = null;
    pulled ? change(...ends) : draw();
  });
  svg.addEventListener("pointercancel", () => { held = null; draw(); });
  svg.addEventListener("dblclick", actions.whole);
  svg.addEventListener("wheel", (event) => {
    if (document.activeElement !== svg) return; // the page scrolls, unless the picture was clicked
    event.preventDefault();
    zoom(event.deltaY < 0 ? 0.8 : 1.25, timeAt(event));
  }, { passive: false });
  let width = 0;
  new ResizeObserver(() => {
    if (svg.parentElement.clientWidth === width) return;
    width = svg.parentElement.clientWidth;
    draw();
  }).observe(svg.parentElement);
}

async function begin() {
  const query = new URLSearchParams(location.search), offsets = query.getAll("offset");
  const present = new Set(boxes().map((box) => box.value));
  query.getAll("file").forEach((file, i) => {
    if (present.has(file)) chosen.set(file, { offset: Number(offsets[i] ?? 0) || 0, samples: new Map() });
  });
  query.getAll("channel").forEach((channel) => shown.add(channel));
  boxes().forEach((box) => {
    // What was marked before this script arrived is meant as well.
    if (box.checked && !chosen.has(box.value)) chosen.set(box.value, { offset: 0, samples: new Map() });
    box.checked = chosen.has(box.value);
  });
  if (query.has("low") && Number(query.get("high")) > Number(query.get("low"))) view = [Number(query.get("low")), Number(query.get("high"))];
  listen();
  try {
    await learn(files());
  } catch (error) {
    field("refusal").textContent = error.message;
  }
  if (!shown.size) known.values().next().value?.channels?.slice(0, 1).forEach(({ name }) => shown.add(name));
  lists();
  draw();
  if (files().length) await ask();
  svg.dataset.begun = "";
}

begin();
