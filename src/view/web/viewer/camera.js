// Where panels are seen from. All panels of bodies share one camera, all panels of planes another.
const FIELD = (28 * Math.PI) / 180;
const HOME = { yaw: 0, pitch: 0, zoom: 1, pan: [0, 0] }; // the angles are the scene's
const FLAT_HOME = { yaw: 0, pitch: 0, zoom: 1, pan: [0, 0] };
const MARGIN = 1.09;
/** Pixels that a panel's heading takes. */
const HEADING = 52;

function newCameras() {
  return { body: { ...HOME, pan: [0, 0], focus: null }, plane: { ...FLAT_HOME, pan: [0, 0], focus: null } };
}

const cameraOf = (cameras, panel) => (panel.flat ? cameras.plane : cameras.body);
const rowsOf = (camera) => turntable(camera.yaw, camera.pitch);

/** Calls `take(x, y, z)` for all vertices as they are seen from home, in the spaces that a panel shows. */
function eachSeen(surface, panel, take) {
  const rows = panel.flat ? turntable(0, 0) : turntable(HOME.yaw, HOME.pitch);
  const spaces = panel.at === "first" ? [0] : panel.at === "second" ? [1] : [0, 1];
  for (const space of spaces) {
    const at = surface.positions[space];
    for (let v = 0; v < at.length; v += 3) take(...rows.map((row) => row[0] * at[v] + row[1] * at[v + 1] + row[2] * at[v + 2]));
  }
}

/** The middle of the box around what a panel shows, seen from home. */
function middleOfView(surface, panel) {
  const rows = panel.flat ? turntable(0, 0) : turntable(HOME.yaw, HOME.pitch);
  const [low, high] = panel.backdrop ? [[-1, -1, 0], [1, 1, 0]] : [[9, 9, 9], [-9, -9, -9]];
  eachSeen(surface, panel, (...at) => {
    for (let k = 0; k < 3; k++) {
      low[k] = Math.min(low[k], at[k]);
      high[k] = Math.max(high[k], at[k]);
    }
  });
  const seen = mixed(low, high, 0.5);
  return { seen, middle: [0, 1, 2].map((j) => rows[0][j] * seen[0] + rows[1][j] * seen[1] + rows[2][j] * seen[2]) };
}

/** The distance from which a panel shows all of its surface, at the size that it has. */
function distanceFor(surface, panel) {
  const slope = Math.tan(FIELD / 2);
  const free = Math.max(panel.height - HEADING, panel.height * 0.6) / panel.height;
  const across = (MARGIN * panel.height) / panel.width / slope;
  const up = MARGIN / free / slope;
  let needed = panel.backdrop ? Math.max(across, up) : 1;
  eachSeen(surface, panel, (x, y, z) => {
    const [dx, dy, dz] = [Math.abs(x - panel.seen[0]), Math.abs(y - panel.seen[1]), z - panel.seen[2]];
    needed = Math.max(needed, Math.max(dx * across, dy * up) + dz);
  });
  return needed;
}

/** The distance from which all panels of one kind and size show all of their surfaces. */
function fittingDistance(scene, { flat, width, height }) {
  const alike = (p) => p.flat === flat && Math.abs(p.width - width) < 4 && Math.abs(p.height - height) < 4;
  const needed = scene.panels.filter((p) => alike(p) && p.width > 0).map((panel) => {
    const size = `${panel.width} ${panel.height}`;
    if (panel.fittedTo !== size) Object.assign(panel, { fittedTo: size, needs: distanceFor(scene.surfaces[panel.surface], panel) });
    return panel.needs;
  });
  return Math.max(...needed, 1);
}

/** The matrices of a panel; `focus` is the point that stands in its middle. */
function matricesOf(camera, panel, distance, focus) {
  const rows = rowsOf(camera);
  const away = distance / camera.zoom;
  const shift = rows.map((row) => -dot(row, focus));
  // The heading takes the panel's upper edge, so the middle lies a little below.
  const down = (HEADING / 2 / Math.max(panel.height, 1)) * 2 * away * Math.tan(FIELD / 2);
  const move = [shift[0] + camera.pan[0], shift[1] + camera.pan[1] - down, shift[2] - away];
  const view = new Float32Array(16);
  for (let k = 0; k < 3; k++) {
    for (let j = 0; j < 3; j++) view[4 * j + k] = rows[k][j];
    view[12 + k] = move[k];
  }
  view[15] = 1;
  const [near, far] = [Math.max(away - 2.6, away * 0.02), away + 2.6];
  const scale = 1 / Math.tan(FIELD / 2);
  const projection = new Float32Array(16);
  projection[0] = (scale * panel.height) / Math.max(panel.width, 1);
  projection[5] = scale;
  projection[10] = -(far + near) / (far - near);
  projection[11] = -1;
  projection[14] = (-2 * far * near) / (far - near);
  return { view, projection, rows, move, away };
}

/** The ray through a point of a panel, in pixels from its upper left corner: where it starts, and its direction. */
function rayThrough({ rows, move }, panel, x, y) {
  const slope = Math.tan(FIELD / 2);
  const seen = [((2 * x - panel.width) / panel.height) * slope, (1 - (2 * y) / panel.height) * slope, -1];
  const back = (v) => [0, 1, 2].map((j) => rows[0][j] * v[0] + rows[1][j] * v[1] + rows[2][j] * v[2]);
  return { start: back(scaled(move, -1)), way: unit(back(seen)) };
}

/** Where a point appears in a panel, in pixels, and how far away it is. */
function seenAt({ view, projection }, panel, point) {
  const at = transformed(view, point);
  const clip = transformed(projection, at.slice(0, 3));
  return [((clip[0] / clip[3] + 1) / 2) * panel.width, ((1 - clip[1] / clip[3]) / 2) * panel.height, -at[2]];
}

/** The pan by which a drag over so many pixels moves what stands in the middle. */
function panBy(camera, panel, distance, dx, dy) {
  const perPixel = (2 * (distance / camera.zoom) * Math.tan(FIELD / 2)) / panel.height;
  camera.pan = [camera.pan[0] + dx * perPixel, camera.pan[1] - dy * perPixel];
}

/** Angles from which a direction is seen head on. */
function facing(normal) {
  return { yaw: Math.atan2(-normal[0], normal[2]), pitch: Math.asin(clamp(normal[1], -0.98, 0.98)) };
}
