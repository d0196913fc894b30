// A figure as CSV, from its data, and as PNG, from its drawing.

function offer(blob, name) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

// "School bus", "empty_bounce.csv" and "The whole recording": School_bus-empty_bounce_csv-The_whole_recording
function fileName(figure, held, ending) {
  const drop = figure.closest("details")?.dataset.drop;
  const parts = [document.querySelector("h1").textContent, drop === held.title ? "" : drop, held.title].filter(Boolean);
  return `${parts.map((part) => part.replace(/[^\p{L}\p{N}]+/gu, "_").replace(/^_|_$/g, "")).join("-")}.${ending}`;
}

const quoted = (text) => (/[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);
const cell = (value, figures) => (Number.isFinite(value) ? String(Number(value.toPrecision(figures))) : "");

// One row for each x where all curves share it, otherwise one row for each point; what is out of sight is left out.
function csvOf(held, columns, low, high, shows) {
  const curves = held.panels.flatMap((panel) => panel.curves.map((curve) => ({ panel, curve }))).filter(shows);
  const lines = curves.filter(({ curve }) => !curve.points);
  const inside = (x) => x >= low && x <= high;
  if (lines.length && lines.every(({ curve }) => curve.x === lines[0].curve.x)) {
    const x = columns[lines[0].curve.x];
    const heads = lines.map(({ panel, curve }) => [curve.name, panel.name].filter(Boolean).join(": "));
    const rows = [[held.x.label, ...heads].map(quoted).join(",")];
    x.forEach((value, i) => {
      if (inside(value)) rows.push([cell(value, 9), ...lines.map(({ curve }) => cell(columns[curve.y][i], 6))].join(","));
    });
    return `${rows.join("\r\n")}\r\n`;
  }
  const rows = [["panel", "curve", held.x.label, "value", "95 % interval, half-length"].map(quoted).join(",")];
  for (const { panel, curve } of curves) {
    columns[curve.x].forEach((value, i) => {
      const y = columns[curve.y][i];
      const bar = "bars" in curve ? cell(columns[curve.bars][i], 6) : "";
      if (inside(value) && Number.isFinite(y)) rows.push([quoted(panel.name), quoted(curve.name), cell(value, 9), cell(y, 6), bar].join(","));
    });
  }
  return `${rows.join("\r\n")}\r\n`;
}

// The drawing in the colours of paper, three pixels to its unit.
async function pngOf(svg) {
  const copy = svg.cloneNode(true);
  copy.querySelectorAll(".cursor, .reading").forEach((one) => one.remove());
  const [, , width, height] = svg.getAttribute("viewBox").split(" ").map(Number);
  const style = document.createElementNS(svg.namespaceURI, "style");
  style.textContent = document.getElementById("light").textContent + document.getElementById("pictures").textContent;
  copy.prepend(style);
  copy.setAttribute("width", width * 3);
  copy.setAttribute("height", height * 3);
  const image = new Image();
  image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(new XMLSerializer().serializeToString(copy))}`;
  await image.decode();
  const canvas = Object.assign(document.createElement("canvas"), { width: width * 3, height: height * 3 });
  const context = canvas.getContext("2d");
  context.fillStyle = "#ffffff";
  context.fillRect(0, 0, canvas.width, canvas.height);
  context.drawImage(image, 0, 0, canvas.width, canvas.height);
  return new Promise((done) => { canvas.toBlob(done, "image/png"); });
}
