// The recording of each drop, drawn when it comes into view, with handles for the limits of what is used.
import { svgOf } from "./sketch.js";

const STEP = 0.01, FAST = 0.1; // s, of the arrow keys without and with Shift
const DETECTED = { start: "start", end: "end" };

export function setUpRecordings(form, body) {
  const seen = new IntersectionObserver((entries) => {
    for (const entry of entries) if (entry.isIntersecting) { seen.unobserve(entry.target); draw(entry.target); }
  }, { rootMargin: "200px" });

  const watch = (details) => { if (details.open) seen.observe(details); };
  for (const details of form.querySelectorAll("details.recording")) {
    watch(details);
    details.addEventListener("toggle", () => watch(details));
  }

  async function draw(details) {
    const place = details.querySelector(".drawn");
    place.setAttribute("aria-busy", "true");
    const waits = place.querySelector(".subdued");
    if (waits) waits.textContent = "Reading the recording …";
    const address = `${form.getAttribute("action").replace("/campaign?", "/campaign/drop?")}&drop=${details.dataset.drop}`;
    const answer = await fetch(address, { method: "POST", body: body() }).catch(() => null);
    place.removeAttribute("aria-busy");
    if (!answer?.ok) {
      const text = document.createElement("p");
      text.className = "problem";
      text.textContent = answer ? (await answer.text()).trim() : "sprung does not answer.";
      place.replaceChildren(text, again(details));
      return;
    }
    const found = await answer.json();
    const svg = svgOf(found.svg);
    const facts = document.createElement("ul");
    facts.className = "facts";
    for (const fact of found.facts) {
      const line = document.createElement("li");
      line.textContent = fact;
      facts.append(line);
    }
    place.replaceChildren(svg, facts, again(details));
    addHandles(details, svg, found);
  }

  function again(details) {
    const button = document.createElement("button");
    button.type = "button";
    button.className = "small";
    button.textContent = "Detect again";
    button.title = "Detects release, landing and free decay with what is entered now";
    button.addEventListener("click", () => draw(details));
    return button;
  }

  function addHandles(details, svg, found) {
    const group = details.closest("fieldset").id;
    const { frame, limits, times } = found;
    const [, , width, height] = svg.getAttribute("viewBox").split(" ").map(Number);
    svg.setAttribute("viewBox", `0 -16 ${width} ${height + 16}`); // room for the grips
    const across = (time) => frame.left + frame.width * (time - frame.low) / (frame.high - frame.low);
    const handles = [["start", "Free decay from", "start"], ["end", "Free decay to", "end"], ["window.0", "Part of the recording, from", ""], ["window.1", "Part of the recording, to", ""]];
    for (const [key, label, detected] of handles) {
      const input = document.getElementById(`${group}.${key}`);
      if (!input) continue;
      const read = () => Number(input.value.replace(",", "."));
      const isStated = () => input.value.trim() !== "" && Number.isFinite(read());
      const fallback = detected ? times[DETECTED[detected]] ?? limits[key === "end" ? 1 : 0] : limits[key === "window.1" ? 1 : 0];
      const handle = svgElement("g", { class: `handle ${detected ? "decay" : "window"}`, tabindex: "0", role: "slider", "aria-valuemin": limits[0].toFixed(3), "aria-valuemax": limits[1].toFixed(3) }, svg);
      const side = key === "end" || key === "window.1" ? -1 : 1;
      svgElement("path", { class: "line", d: `M0 ${frame.top}V${frame.bottom}` }, handle);
      svgElement("path", { class: "grip", d: detected ? `M0 ${frame.top}v-14h${9 * side}v7z` : `M0 ${frame.bottom}v-14h${9 * side}v7z` }, handle);
      // Where two handles lie on each other, those of the part are reached below, those of the decay above.
      const reach = detected ? [frame.top - 15, frame.bottom - 26] : [frame.bottom - 26, frame.bottom + 4];
      svgElement("rect", { class: "reach", x: -8, y: reach[0], width: 16, height: reach[1] - reach[0] }, handle);
      const show = () => {
        const time = isStated() ? read() : fallback;
        const x = Math.min(Math.max(across(time), frame.left), frame.left + frame.width);
        handle.setAttribute("transform", `translate(${x.toFixed(1)} 0)`);
        handle.classList.toggle("stated", isStated());
        handle.setAttribute("aria-valuenow", time.toFixed(3));
        handle.setAttribute("aria-valuetext", `${time.toFixed(3)} s, ${isStated() ? "stated" : detected ? "as detected" : "end of the recording"}`);
        handle.setAttribute("aria-label", `${label}. Arrow keys move it by 0.01 s, with Shift by 0.1 s; Delete leaves it to the program.`);
      };
      const set = (time) => {
        const inside = Math.min(Math.max(time, limits[0]), limits[1]);
        const comma = input.value.includes(",");
        input.value = inside.toFixed(3).replace(".", comma ? "," : ".");
        // A part of a recording has two ends.
        const other = key.startsWith("window") && document.getElementById(`${group}.window.${key.endsWith("0") ? 1 : 0}`);
        if (other && other.value.trim() === "") other.value = limits[key.endsWith("0") ? 1 : 0].toFixed(3);
        input.dispatchEvent(new Event("input", { bubbles: true }));
      };
      handle.addEventListener("keydown", (event) => {
        const by = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1 }[event.key];
        if (event.key === "Delete" || event.key === "Backspace") { input.value = ""; input.dispatchEvent(new Event("input", { bubbles: true })); }
        else if (by) set((isStated() ? read() : fallback) + by * (event.shiftKey ? FAST : STEP));
        else return;
        event.preventDefault();
      });
      handle.addEventListener("pointerdown", (event) => { if (!event.button) { handle.setPointerCapture(event.pointerId); event.preventDefault(); handle.focus(); } });
      handle.addEventListener("pointermove", (event) => {
        if (!handle.hasPointerCapture(event.pointerId)) return;
        const point = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
        set(frame.low + (frame.high - frame.low) * (point.x - frame.left) / frame.width);
      });
      input.addEventListener("input", show);
      form.addEventListener("input", (event) => { if (event.target.name?.startsWith(`${group}.`)) show(); });
      show();
    }
  }
}

function svgElement(kind, attributes, parent) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", kind);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  parent.append(made);
  return made;
}
