// The page of the motion: what is shown, how fast, from where, and what is saved of it.
import { animatedPng } from "/scripts/apng.js";
import { svgOf } from "/scripts/sketch.js";
import { VIEWS, draw, prepare } from "/scripts/wire_frame.js";

const canvas = document.querySelector("#frame");
const field = (name) => document.querySelector(`#${name}`);
const { results, name: vehicle } = canvas.dataset;
const announce = (text) => { document.querySelector("#announcements").textContent = text; };
const LARGEST = 0.13; // rise that a motion is enlarged to, in wheelbases
const FRAMES = 120; // of an animated file, at most
const STILL = [1200, 750], MOVING = [800, 500]; // pixels of what is saved
const PER_SECOND = 25; // pictures of an animated file per second

let scene = null, motion = null, playing = false, at = 0, last = 0;
const camera = { ...VIEWS.oblique, zoom: 1 };

async function fetchJson(address) {
  const answer = await fetch(address, { headers: { Accept: "application/json" } });
  if (!answer.ok) throw new Error(await answer.text());
  return answer.json();
}

// Rises in m of a mode at a time in s: the shape turned by the phase; an overdamped one decays.
function ofMode(mode) {
  const size = LARGEST * scene.wheelbase, period = mode.creeps ? 1 : 1 / mode.frequency;
  return {
    name: `${mode.name}, ${mode.load}`, note: mode.caption, start: 0, end: period, repeats: true, factor: 1, unit: size,
    rises: (time) => {
      const phase = (2 * Math.PI * time) / period;
      return mode.real.map((real, i) => mode.creeps ? real * Math.exp(-phase / 2) : real * Math.cos(phase) - mode.imaginary[i] * Math.sin(phase));
    },
  };
}

// Rises in m of a drop at a time in s, enlarged so that the largest is seen.
function ofDrop(name, data) {
  const { time, rises } = data;
  const largest = Math.max(...rises.map((row) => Math.max(...row.map(Math.abs)))) / 1000 || 1;
  const step = (time.at(-1) - time[0]) / (time.length - 1);
  return {
    name, note: `load ${data.load}; ${data.how}`, start: time[0], end: time.at(-1), repeats: false,
    factor: (LARGEST * scene.wheelbase) / largest, unit: 1,
    rises: (now) => {
      const place = Math.min(Math.max((now - time[0]) / step, 0), time.length - 1), i = Math.min(Math.floor(place), time.length - 2);
      return rises.map((row) => (row[i] + (place - i) * (row[i + 1] - row[i])) / 1000);
    },
  };
}

const size = () => 2 ** Number(field("size").value);
const speed = () => Number(field("speed").value);
const risesAt = (time) => motion.rises(time).map((rise) => rise * motion.unit * motion.factor * size());
const paper = () => scene.colours;

function screenColours() {
  const style = getComputedStyle(document.documentElement);
  return Object.fromEntries(Object.keys(scene.colours).map((name) => [name, style.getPropertyValue(`--${name}`).trim()]));
}

function caption() {
  const enlarged = motion.unit === 1 ? `, displacements ${(motion.factor * size()).toPrecision(2)} times` : "";
  const time = motion.repeats ? "" : `, ${at.toFixed(3)} s`;
  return `${vehicle}: ${motion.name}${time}${enlarged}`;
}

function show() {
  if (!scene || !motion) return;
  const ratio = devicePixelRatio || 1;
  const [width, height] = [canvas.clientWidth, canvas.clientHeight].map((length) => Math.round(length * ratio));
  if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
  draw(canvas.getContext("2d", { alpha: false }), width, height, scene, camera, risesAt(at), screenColours());
  field("time").value = (at - motion.start) / (motion.end - motion.start);
  field("now").textContent = caption();
}

function step(now) {
  if (!playing) return;
  const length = motion.end - motion.start;
  at += (Math.min(now - last, 100) / 1000) * speed();
  last = now;
  if (at > motion.end) at = motion.start + ((at - motion.start) % length);
  show();
  requestAnimationFrame(step);
}

function play(on) {
  playing = on && motion !== null;
  field("play").textContent = playing ? "Pause" : "Play";
  if (playing) { last = performance.now(); requestAnimationFrame(step); }
}

async function choose() {
  const [kind, key] = [field("motion").value.slice(0, 5), field("motion").value.slice(5)];
  field("refusal").textContent = "";
  try {
    motion = kind === "mode:" ? ofMode(scene.modes[Number(key)])
      : ofDrop(key, await fetchJson(`/motion/drop?results=${encodeURIComponent(results)}&drop=${encodeURIComponent(key)}`));
  } catch (error) {
    field("refusal").textContent = error.message;
    return;
  }
  at = motion.start;
  field("note").textContent = motion.note;
  canvas.setAttribute("aria-label", `Wire frame of ${vehicle}: ${motion.name}, ${motion.note}`);
  canvas.dataset.ready = motion.name;
  show();
}

// Saved pictures are on white, in the colours of paper, whatever the screen shows.
async function png(time, [width, height]) {
  const picture = Object.assign(document.createElement("canvas"), { width, height });
  const before = at;
  at = time;
  draw(picture.getContext("2d", { alpha: false }), width, height, scene, camera, risesAt(time), paper(), caption());
  at = before;
  return new Promise((done) => { picture.toBlob(done, "image/png"); });
}

function offer(blob, ending) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = `${[vehicle, motion.name].map((part) => part.replace(/[^\p{L}\p{N}]+/gu, "_")).join("-")}.${ending}`;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

async function saveAnimation() {
  const button = field("animation"), was = playing;
  play(false);
  button.disabled = true;
  const length = motion.end - motion.start, wanted = Math.round((length / speed()) * PER_SECOND);
  const count = Math.min(Math.max(wanted, 12), FRAMES);
  const frames = [];
  for (let i = 0; i < count; i++) {
    frames.push(new Uint8Array(await (await png(motion.start + (length * i) / (motion.repeats ? count : count - 1), MOVING)).arrayBuffer()));
    button.textContent = `Picture ${i + 1} of ${count}`;
  }
  offer(animatedPng(frames, (1000 * length) / speed() / count), "animated.png");
  button.textContent = "Save the animation (animated PNG)";
  button.disabled = false;
  announce(`The animation was saved with ${count} pictures.`);
  play(was);
}

function turn(right, up, closer = 1) {
  camera.turn += right;
  camera.tilt = Math.min(Math.max(camera.tilt + up, -Math.PI / 2), Math.PI / 2);
  camera.zoom = Math.min(Math.max(camera.zoom * closer, 0.3), 6);
  show();
}

function moveTime(part) {
  play(false);
  const length = motion.end - motion.start;
  at = Math.min(Math.max(at + part * length, motion.start), motion.end);
  show();
}

const KEYS = {
  ArrowLeft: () => turn(0.09, 0), ArrowRight: () => turn(-0.09, 0), ArrowUp: () => turn(0, 0.09), ArrowDown: () => turn(0, -0.09),
  "+": () => turn(0, 0, 1.15), "-": () => turn(0, 0, 1 / 1.15), Home: () => { Object.assign(camera, VIEWS.oblique, { zoom: 1 }); show(); },
  " ": () => play(!playing), ",": () => moveTime(-0.01), ".": () => moveTime(0.01),
};

function listen() {
  canvas.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || !KEYS[event.key]) return;
    event.preventDefault();
    KEYS[event.key]();
  });
  let held = null;
  canvas.addEventListener("pointerdown", (event) => { held = [event.clientX, event.clientY]; canvas.setPointerCapture(event.pointerId); });
  canvas.addEventListener("pointermove", (event) => {
    if (!held) return;
    turn(-(event.clientX - held[0]) / 150, (event.clientY - held[1]) / 150);
    held = [event.clientX, event.clientY];
  });
  for (const kind of ["pointerup", "pointercancel"]) canvas.addEventListener(kind, () => { held = null; });
  canvas.addEventListener("wheel", (event) => {
    if (!event.ctrlKey && document.activeElement !== canvas) return; // the page scrolls, unless the frame was clicked
    event.preventDefault();
    turn(0, 0, event.deltaY < 0 ? 1.1 : 1 / 1.1);
  }, { passive: false });
  document.querySelectorAll("[data-view]").forEach((button) => button.addEventListener("click", () => {
    Object.assign(camera, VIEWS[button.dataset.view]);
    show();
  }));
  field("motion").addEventListener("change", choose);
  field("play").addEventListener("click", () => play(!playing));
  field("size").addEventListener("input", show);
  field("time").addEventListener("input", () => {
    play(false);
    at = motion.start + Number(field("time").value) * (motion.end - motion.start);
    show();
  });
  field("still").addEventListener("click", async () => offer(await png(at, STILL), "png"));
  field("animation").addEventListener("click", saveAnimation);
  field("damper-drop").addEventListener("change", dampers);
  new ResizeObserver(show).observe(canvas);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", show);
}

function options(select, title, entries) {
  const group = Object.assign(document.createElement("optgroup"), { label: title });
  for (const [value, text] of entries) group.append(Object.assign(document.createElement("option"), { value, textContent: text }));
  if (entries.length) select.append(group);
}

// The dampers: pictures that the server draws.
async function dampers() {
  const place = field("dampers"), drop = field("damper-drop").value;
  place.setAttribute("aria-busy", "true");
  try {
    const found = await fetchJson(`/motion/dampers?results=${encodeURIComponent(results)}&drop=${encodeURIComponent(drop)}`);
    place.replaceChildren(...found.pictures.map((svg) => {
      const figure = document.createElement("figure");
      figure.append(svgOf(svg));
      const title = document.createElement("figcaption");
      title.textContent = figure.querySelector("title").textContent;
      figure.prepend(title);
      return figure;
    }));
  } catch (error) {
    place.replaceChildren(Object.assign(document.createElement("p"), { className: "note", textContent: error.message }));
  }
  place.removeAttribute("aria-busy");
}

async function begin() {
  try {
    scene = prepare(await fetchJson(`/motion/scene?results=${encodeURIComponent(results)}`));
  } catch (error) {
    field("refusal").textContent = error.message;
    return;
  }
  const loads = [...new Set(scene.modes.map(({ load }) => load))];
  for (const load of loads) {
    options(field("motion"), `Modes, ${load}`, scene.modes.map((mode, i) => [mode, i]).filter(([mode]) => mode.load === load)
      .map(([mode, i]) => [`mode:${i}`, `${mode.name}, ${mode.caption}`]));
  }
  options(field("motion"), "Drops, as fitted", scene.drops.map((drop) => [`drop:${drop}`, drop]));
  options(field("damper-drop"), "One drop", scene.drops.map((drop) => [drop, drop]));
  field("why").textContent = scene.why;
  field("why").hidden = !scene.why;
  field("dampers-section").hidden = !scene.drops.length;
  field("stage").hidden = !field("motion").options.length;
  if (!field("motion").options.length) return;
  listen();
  await choose();
  if (motion && !matchMedia("(prefers-reduced-motion: reduce)").matches) play(true);
  if (scene.drops.length) {
    field("damper-drop").value = scene.drops[0];
    await dampers();
  }
}

begin();
