// Sensors of the sketch: moved with the mouse or with the arrow keys; the numbers in the form are the truth.

const STEP = 0.01, FAST = 0.1; // m, of the arrow keys without and with Shift

export function setUpSketch(form, changed) {
  const place = document.querySelector("#sketch");
  const unplaced = document.querySelector("#unplaced");
  let held = null;

  // Two sensors may have one name until that is corrected: the marks of a drawing stand in the order of the sensors that it shows.
  const marksOf = (svg, channel) => [...svg.querySelectorAll(`[data-channel="${CSS.escape(channel)}"]`)];
  const isDrawn = (group) => !isOnBody(group) || numbers(group).every((field) => field.value.trim() !== "");
  function sensorOf(mark) {
    const channel = mark.dataset.channel;
    const groups = [...form.querySelectorAll("fieldset.sensor")].filter((group) => input(group, "channel").value === channel && isDrawn(group));
    return groups[marksOf(mark.closest("svg"), channel).indexOf(mark)] ?? groups[0];
  }
  const input = (group, key) => document.getElementById(`${group.id}.${key}`);
  const numbers = (group) => [0, 1, 2].map((i) => input(group, `position.${i}`));
  const read = (field) => Number(field.value.replace(",", ".").replace("\u2212", "-"));
  const comma = () => [...form.querySelectorAll("input")].some((field) => /^\s*-?\d+,\d+\s*$/.test(field.value));
  const write = (field, value) => { field.value = value.toFixed(2).replace(/^-0\.00$/, "0.00").replace(".", comma() ? "," : "."); };

  // In the plan view y points up, in the side view z.
  function frameOf(svg) {
    const frame = svg.querySelector("g.frame");
    const [x, y] = frame.dataset.origin.split(" ").map(Number);
    return { up: frame.dataset.view === "Plan view" ? 1 : 2, scale: Number(frame.dataset.scale), x, y };
  }

  function setUpMarks() {
    for (const mark of place.querySelectorAll("[data-channel]")) {
      const group = sensorOf(mark);
      if (!group) continue;
      mark.setAttribute("tabindex", "0");
      mark.setAttribute("role", "button");
      mark.setAttribute("r", "5");
      describe(mark, group);
    }
    const without = [...form.querySelectorAll("fieldset.sensor")].filter((group) => input(group, "on").value === "body" && numbers(group).some((field) => field.value.trim() === "") && !input(group, "relative_to")?.value);
    unplaced.replaceChildren();
    unplaced.hidden = !without.length;
    if (without.length) unplaced.append("Not placed yet: ");
    for (const group of without) {
      const button = document.createElement("button");
      button.type = "button";
      button.className = "small";
      button.textContent = `Place ${input(group, "channel").value || group.querySelector("legend").textContent}`;
      button.addEventListener("click", () => putInTheMiddle(group));
      unplaced.append(button);
    }
  }

  function describe(mark, group) {
    const at = isOnBody(group) ? numbers(group).map((field, i) => `${"xyz"[i]} ${field.value || "not stated"}`).join(", ") : `on ${input(group, "on").value}`;
    mark.setAttribute("aria-label", `${mark.dataset.channel}, ${at}. ${isOnBody(group) ? "Arrow keys move it by 1 cm, with Shift by 10 cm." : "Arrow keys move it to another wheel."}`);
  }

  const isOnBody = (group) => input(group, "on").value === "body";

  function putInTheMiddle(group) {
    const wheelbase = read(document.getElementById("vehicle.wheelbase.value")) || 2.7;
    const values = [-wheelbase / 2, 0, 0.5];
    numbers(group).forEach((field, i) => { if (field.value.trim() === "") write(field, values[i]); });
    focusAfter = input(group, "channel").value;
    changed();
  }
  let focusAfter = "";

  function move(group, svg, to) {
    const frame = frameOf(svg);
    const fields = numbers(group);
    write(fields[0], to[0]);
    write(fields[frame.up], to[1]);
    for (const mark of marksOf(place, input(group, "channel").value).filter((mark) => sensorOf(mark) === group)) {
      const own = frameOf(mark.closest("svg"));
      mark.setAttribute("cx", own.x + own.scale * read(fields[0]));
      mark.setAttribute("cy", own.y - own.scale * read(fields[own.up]));
      describe(mark, group);
    }
  }

  // A sensor on a wheel goes to the wheel that is nearest.
  function wheelNear(svg, to) {
    const stations = [...input(held.group, "on").options].map((option) => option.value);
    const wheelbase = read(document.getElementById("vehicle.wheelbase.value")) || 2.7;
    const front = to[0] > -wheelbase / 2, left = frameOf(svg).up === 1 ? to[1] > 0 : null;
    const wanted = stations.filter((station) => !station.startsWith("pad") && station !== "body").find((station) => matches(station, front, left, input(held.group, "on").value));
    return wanted;
  }
  const matches = (station, front, left, now) => {
    if (station.length !== 2) return { front, rear: !front, left, right: left === false }[station] ?? station === "wheel";
    return station[0] === (front ? "f" : "r") && station[1] === (left === null ? now[1] : left ? "l" : "r");
  };

  const pointOf = (svg, event) => {
    const point = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
    const frame = frameOf(svg);
    return [(point.x - frame.x) / frame.scale, (frame.y - point.y) / frame.scale];
  };

  place.addEventListener("pointerdown", (event) => {
    const mark = event.target.closest?.("[data-channel]");
    const group = mark && sensorOf(mark);
    if (!group || event.button) return;
    held = { mark, group, svg: mark.closest("svg"), moved: false };
    place.setPointerCapture(event.pointerId);
    event.preventDefault();
    mark.focus();
  });
  place.addEventListener("pointermove", (event) => {
    if (!held) return;
    held.moved = true;
    const to = pointOf(held.svg, event);
    if (isOnBody(held.group)) move(held.group, held.svg, to);
    else {
      const frame = frameOf(held.svg);
      held.mark.setAttribute("cx", frame.x + frame.scale * to[0]);
      held.mark.setAttribute("cy", frame.y - frame.scale * to[1]);
      held.to = to;
    }
  });
  const drop = () => {
    if (!held) return;
    if (held.to) {
      const wheel = wheelNear(held.svg, held.to);
      if (wheel) input(held.group, "on").value = wheel;
    }
    if (held.moved) { focusAfter = held.mark.dataset.channel; changed(); }
    held = null;
  };
  place.addEventListener("pointerup", drop);
  place.addEventListener("pointercancel", drop);

  place.addEventListener("keydown", (event) => {
    const mark = event.target.closest?.("[data-channel]");
    const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    const group = mark && sensorOf(mark);
    if (!step || !group) return;
    event.preventDefault();
    focusAfter = mark.dataset.channel;
    const svg = mark.closest("svg");
    const frame = frameOf(svg);
    if (!isOnBody(group)) {
      held = { mark, group };
      const wheel = wheelNear(svg, [step[0] ? (step[0] > 0 ? 0 : -99) : input(group, "on").value[0] === "f" ? 0 : -99, step[1] ? step[1] : input(group, "on").value[1] === "l" ? 1 : -1]);
      held = null;
      if (wheel) { input(group, "on").value = wheel; changed(); }
      return;
    }
    const fields = numbers(group);
    const size = event.shiftKey ? FAST : STEP;
    move(group, svg, [read(fields[0]) + size * step[0], read(fields[frame.up]) + size * step[1]]);
    changed();
  });

  // The server draws the sketch anew, with its labels where there is room for them.
  function replace(sketch) {
    if (held) return;
    const view = place.querySelector("[data-channel]:focus")?.closest("svg").getAttribute("aria-label");
    place.replaceChildren(...sketch.drawings.map((drawing) => {
      const figure = document.createElement("figure");
      const caption = document.createElement("figcaption");
      caption.textContent = drawing.title;
      figure.append(caption, svgOf(drawing.svg));
      return figure;
    }));
    document.querySelector("#unknown").textContent = sketch.unknown.length ? `Not known, drawn dashed or not at all: ${sketch.unknown.join("; ")}.` : "";
    setUpMarks();
    if (!focusAfter) return;
    const marks = [...place.querySelectorAll(`[data-channel="${CSS.escape(focusAfter)}"]`)];
    const mark = marks.find((one) => one.closest("svg").getAttribute("aria-label") === view) ?? marks[0];
    if (document.activeElement === document.body || document.activeElement === null) mark?.focus({ preventScroll: true });
    focusAfter = "";
  }

  setUpMarks();
  form.addEventListener("input", (event) => { if (/\.(on|channel|position\.\d)$/.test(event.target.name)) setUpMarks(); });
  return { replace };
}

// A drawing as the server wrote it: parsed as a document, so that nothing in it runs.
export function svgOf(text) {
  const parsed = new DOMParser().parseFromString(`<div xmlns="http://www.w3.org/1999/xhtml">${text.replace("<svg ", '<svg xmlns="http://www.w3.org/2000/svg" ')}</div>`, "application/xhtml+xml");
  return document.importNode(parsed.querySelector("svg"), true);
}
