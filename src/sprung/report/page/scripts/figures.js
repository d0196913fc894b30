// Figures: saved by a click; recordings and fits are also zoomed, read out, and their channels switched on and off.
// A drawing is complete without any of this.

function element(kind, attributes, parent) {
  const svg = kind === "path" || kind === "text" || kind === "rect";
  const made = svg ? document.createElementNS(document.querySelector("svg").namespaceURI, kind) : document.createElement(kind);
  for (const [key, value] of Object.entries(attributes)) key === "text" ? (made.textContent = value) : made.setAttribute(key, value);
  parent?.append(made);
  return made;
}

function setUp(script) {
  const figure = script.closest("figure");
  const svg = figure.querySelector("svg.picture");
  const held = JSON.parse(script.textContent);
  let decoded = null;
  const columns = () => (decoded ??= decode(held));
  const scope = held.zoomable ? scopeOf(figure, svg, held, columns) : null;

  const tools = element("div", { class: "tools" });
  figure.querySelector("figcaption").after(tools);
  const button = (text, label, act) => {
    const made = element("button", { type: "button", text, "aria-label": `${label}: ${held.title}`, title: label }, tools);
    made.addEventListener("click", act);
  };
  if (scope) {
    button("+", "Zoom in", () => scope.zoom(0.5));
    button("−", "Zoom out", () => scope.zoom(2));
    button("0", "Whole range", () => scope.reset());
    button("↕", "Fit the heights to what is seen", () => scope.fit());
  }
  button("CSV", "Save the data as CSV", async () => {
    const [low, high] = scope ? scope.range() : [-Infinity, Infinity];
    const text = csvOf(held, await columns(), low, high, scope ? scope.shows : () => true);
    offer(new Blob(["\ufeff", text], { type: "text/csv;charset=utf-8" }), fileName(figure, held, "csv"));
  });
  button("PNG", "Save the picture as PNG", async () => offer(await pngOf(svg), fileName(figure, held, "png")));
  if (scope) scope.switches(tools);
}
