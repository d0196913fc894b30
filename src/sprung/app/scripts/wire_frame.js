// The vehicle as a wire frame in space: camera, projection and drawing. Nothing here knows the page.

export const VIEWS = {
  oblique: { turn: -0.9, tilt: 0.35 },
  left: { turn: 0, tilt: 0 },
  front: { turn: -Math.PI / 2, tilt: 0 },
  above: { turn: 0, tilt: Math.PI / 2 },
};

const SIDES = 28; // of a wheel that is drawn as a polygon
const GROUND = 0.25; // least extent of the ground to either side, in wheelbases
const DISTANCE = 4.5; // of the eye from the vehicle, in wheelbases

// Where points are on a picture: x to the right and y down in pixels, and how far away. The eye is on the left of the vehicle
// for a turn of 0, with the front to the left of the picture.
export function project(point, camera, scene, width, height) {
  const length = scene.wheelbase;
  const [x, y, z] = [point[0] - scene.middle[0], point[1], point[2] - scene.middle[2]];
  const [sin, cos] = [Math.sin(camera.turn), Math.cos(camera.turn)];
  const right = -x * cos - y * sin;
  const near = y * cos - x * sin;
  const up = z * Math.cos(camera.tilt) - near * Math.sin(camera.tilt);
  const depth = near * Math.cos(camera.tilt) + z * Math.sin(camera.tilt);
  const scale = camera.zoom * Math.min(width / 1.9, height / 1.25) / length * DISTANCE * length / (DISTANCE * length - depth);
  return [width / 2 + scale * right, height / 2 - scale * up, depth];
}

// Nodes of the frame whose rises in m are given.
export const raised = (places, rises) => places.map(([x, y, z], i) => [x, y, z + (rises ? rises[i] : 0)]);

// The scene as the server sends it, with the point about which the camera turns.
export function prepare(scene) {
  const along = scene.hubs.map((hub) => scene.places[hub][0]);
  const middle = (Math.min(...along) + Math.max(...along)) / 2;
  return { ...scene, middle: [middle, 0, 0.33 * scene.wheelbase] };
}

function line(context, points, colour, width, dash = []) {
  context.strokeStyle = colour;
  context.lineWidth = width;
  context.setLineDash(dash);
  context.beginPath();
  points.forEach(([x, y], i) => (i ? context.lineTo(x, y) : context.moveTo(x, y)));
  context.stroke();
  context.setLineDash([]);
}

const circle = ([x, y, z], radius) => Array.from({ length: SIDES + 1 }, (_, i) => {
  const angle = (2 * Math.PI * i) / SIDES;
  return [x + radius * Math.cos(angle), y, z + radius * Math.sin(angle)];
});

// Draw the vehicle: at rest as a thin dashed frame, and with its nodes risen by `rises`, in m.
export function draw(context, width, height, scene, camera, rises, colours, caption = "") {
  const at = (point) => project(point, camera, scene, width, height);
  const unit = Math.max(1, Math.min(width, height) / 420);
  context.fillStyle = colours.paper;
  context.fillRect(0, 0, width, height);
  const { places } = scene;
  // A part of a vehicle may have no length or width: the ground below it has some.
  const xs = places.map(([x]) => x), half = Math.max(...places.map(([, y]) => y)) || GROUND * scene.wheelbase;
  const rear = Math.min(-GROUND * scene.wheelbase, ...xs), front = Math.max(GROUND * scene.wheelbase, ...xs);
  for (const y of [-half, 0, half]) line(context, [at([rear, y, 0]), at([front, y, 0])], colours.hair, unit);
  for (let i = 0; i <= 4; i++) {
    const x = rear + (i / 4) * (front - rear);
    line(context, [at([x, -half, 0]), at([x, half, 0])], colours.hair, unit);
  }
  const joined = (pairs, nodes, colour, thick, dash) => pairs.forEach(([i, j]) => line(context, [at(nodes[i]), at(nodes[j])], colour, thick, dash));
  const wheels = (nodes, colour, thick, dash) => scene.hubs.forEach((hub) => line(context, circle(nodes[hub], scene.wheel).map(at), colour, thick, dash));
  joined(scene.edges, places, colours.reference, 0.8 * unit, [3 * unit, 2.5 * unit]);
  const nodes = raised(places, rises);
  wheels(places, colours.reference, 0.8 * unit, [3 * unit, 2.5 * unit]);
  wheels(nodes, colours.residual, 2 * unit);
  joined(scene.struts, nodes, colours.simulated, 2.2 * unit);
  joined(scene.edges, nodes, colours.text, 1.7 * unit);
  nodes.slice(Math.max(...scene.hubs) + 1).forEach((node) => line(context, circle(node, 0.4 * scene.wheel).map(at), colours.mode, 2 * unit));
  context.fillStyle = colours.text;
  context.font = `${11 * unit}px system-ui, sans-serif`;
  context.textAlign = "center";
  const [x, y] = at([front + 0.09 * scene.wheelbase, 0, 0]);
  context.fillText("front", x, y);
  context.textAlign = "left";
  if (caption) context.fillText(caption, 10 * unit, height - 10 * unit, width - 20 * unit);
}
