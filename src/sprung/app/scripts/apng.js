// An animated PNG (https://www.w3.org/TR/png-3/) from still ones of the same size and kind.

const TABLE = Uint32Array.from({ length: 256 }, (_, n) => {
  for (let k = 0; k < 8; k++) n = n & 1 ? 0xedb88320 ^ (n >>> 1) : n >>> 1;
  return n >>> 0;
});

function checksum(bytes) {
  let crc = 0xffffffff;
  for (const byte of bytes) crc = TABLE[(crc ^ byte) & 255] ^ (crc >>> 8);
  return (crc ^ 0xffffffff) >>> 0;
}

function chunk(kind, data) {
  const bytes = new Uint8Array(12 + data.length), view = new DataView(bytes.buffer);
  view.setUint32(0, data.length);
  for (let i = 0; i < 4; i++) bytes[4 + i] = kind.charCodeAt(i);
  bytes.set(data, 8);
  view.setUint32(8 + data.length, checksum(bytes.subarray(4, 8 + data.length)));
  return bytes;
}

function* chunks(png) {
  const view = new DataView(png.buffer, png.byteOffset, png.byteLength);
  for (let at = 8; at < png.length;) {
    const length = view.getUint32(at);
    yield [String.fromCharCode(...png.subarray(at + 4, at + 8)), png.subarray(at + 8, at + 8 + length)];
    at += 12 + length;
  }
}

const numbers = (...fields) => {
  const bytes = new Uint8Array(fields.reduce((sum, [size]) => sum + size, 0)), view = new DataView(bytes.buffer);
  let at = 0;
  for (const [size, value] of fields) {
    size === 4 ? view.setUint32(at, value) : size === 2 ? view.setUint16(at, value) : view.setUint8(at, value);
    at += size;
  }
  return bytes;
};

// `frames`: PNG files as Uint8Array; `milliseconds` for each. It repeats for ever.
export function animatedPng(frames, milliseconds) {
  const parts = [frames[0].subarray(0, 8)];
  let sequence = 0;
  frames.forEach((png, i) => {
    const own = [...chunks(png)];
    const header = own.find(([kind]) => kind === "IHDR")[1];
    if (i === 0) parts.push(chunk("IHDR", header), chunk("acTL", numbers([4, frames.length], [4, 0])));
    const view = new DataView(header.buffer, header.byteOffset);
    const size = [[4, view.getUint32(0)], [4, view.getUint32(4)]];
    parts.push(chunk("fcTL", numbers([4, sequence++], ...size, [4, 0], [4, 0], [2, Math.round(milliseconds)], [2, 1000], [1, 0], [1, 0])));
    for (const [kind, data] of own) {
      if (kind !== "IDAT") continue;
      if (i === 0) { parts.push(chunk("IDAT", data)); continue; }
      const numbered = new Uint8Array(4 + data.length);
      new DataView(numbered.buffer).setUint32(0, sequence++);
      numbered.set(data, 4);
      parts.push(chunk("fdAT", numbered));
    }
  });
  parts.push(chunk("IEND", new Uint8Array(0)));
  return new Blob(parts, { type: "image/png" });
}
