// The data of a figure, as it stands beside its drawing: decoded when it is first needed.

async function decode(held) {
  const packed = Uint8Array.from(atob(held.bytes), (letter) => letter.charCodeAt(0));
  const unpacked = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  const bytes = new Uint8Array(await new Response(unpacked).arrayBuffer());
  const total = bytes.length / 4; // four planes of bytes, the least significant first
  let at = 0;
  return held.columns.map(({ n, low, step, log }) => {
    const values = new Float64Array(n);
    let level = 0;
    for (let i = 0; i < n; i++, at++) {
      const folded = (bytes[at] | bytes[at + total] << 8 | bytes[at + 2 * total] << 16 | bytes[at + 3 * total] << 24) >>> 0;
      level += folded % 2 ? -(folded + 1) / 2 : folded / 2;
      const value = low + step * level;
      values[i] = level < 0 ? NaN : log ? Math.exp(value) : value;
    }
    return values;
  });
}

// Where a value stands along an axis, 0 at its beginning and 1 at its end; and back.
const scaled = (axis, value) => (axis.log ? Math.log(value) : value);
function along(axis, value) {
  const part = (scaled(axis, value) - scaled(axis, axis.low)) / (scaled(axis, axis.high) - scaled(axis, axis.low));
  return axis.descending ? 1 - part : part;
}
function valueAt(axis, part) {
  const value = scaled(axis, axis.low) + (axis.descending ? 1 - part : part) * (scaled(axis, axis.high) - scaled(axis, axis.low));
  return axis.log ? Math.exp(value) : value;
}

// The sample that is nearest to a value of an increasing column.
function nearest(column, value) {
  let low = 0, high = column.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (column[middle] <= value) low = middle; else high = middle;
  }
  return value - column[low] < column[high] - value ? low : high;
}

// At most six round values between two, and how to write them.
function roundTicks(low, high) {
  const power = 10 ** Math.floor(Math.log10((high - low) / 6));
  const step = [1, 2, 5, 10].map((size) => size * power).find((size) => (high - low) / size <= 6);
  const ticks = [];
  for (let k = Math.ceil(low / step - 1e-9); k <= high / step + 1e-9; k++) ticks.push([k * step, written(k * step, 7)]);
  return ticks;
}

// A number with a few figures, a true minus sign and no trailing zeros.
const written = (value, figures) => (Number.isFinite(value) ? String(Number(value.toPrecision(figures))).replace("-", "−") : "–");
