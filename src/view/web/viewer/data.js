// The scene as it stands in the page, its arrays unpacked.
const IN_PARTS = 65535;

function bytesOf(text) {
  const raw = atob(text);
  const bytes = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; i++) bytes[i] = raw.charCodeAt(i);
  return bytes.buffer;
}

function places(text) {
  return Float32Array.from(new Uint16Array(bytesOf(text)), (x) => (x / 65535) * 2 - 1);
}

/** Texture coordinates of all corners; -1e6 where there are none. */
function unpackedUv(text, [x, y, width, height]) {
  return Float32Array.from(new Uint16Array(bytesOf(text)), (step, i) =>
    step === 65535 ? -1e6 : i % 2 === 0 ? x + (step / 65534) * width : y + (step / 65534) * height);
}

function unpacked(surface) {
  const { bytes, wide } = surface;
  const first = places(bytes.positions0);
  const lines = places(bytes.lines0);
  return {
    ...surface,
    positions: [first, bytes.positions1 ? places(bytes.positions1) : first],
    linePoints: [lines, bytes.lines1 ? places(bytes.lines1) : lines],
    corners: wide === 2 ? new Uint16Array(bytesOf(bytes.corners)) : new Uint32Array(bytesOf(bytes.corners)),
    numbers: new Uint32Array(bytesOf(bytes.numbers)),
    values: new Uint16Array(bytesOf(bytes.values)),
    patches: new Uint16Array(bytesOf(bytes.patches)),
    partTriangles: new Uint32Array(bytesOf(bytes.part_triangles)),
    partPatches: new Uint16Array(bytesOf(bytes.part_patches)),
    partCorners: new Uint16Array(bytesOf(bytes.part_corners)),
    uv: surface.uv ? unpackedUv(bytes.uv, surface.uv) : null,
    turned: new Set(surface.flips),
    bytes: null,
  };
}

function readScene() {
  const scene = JSON.parse(document.getElementById("scene").textContent);
  scene.surfaces = scene.surfaces.map(unpacked);
  scene.surfaces.forEach((surface, k) => {
    const own = scene.panels.find((panel) => panel.surface === k && panel.at !== "slider" && !panel.flat);
    surface.home = own?.at === "second" ? 1 : 0;
  });
  return scene;
}

/** The measure that a step of its range stands for; not a number for triangles without one. */
function measured(scale, step) {
  if (step === 65535) return NaN;
  const [low, high] = scale.range;
  const t = step / 65534;
  return scale.spacing === "log" ? low * (high / low) ** t : low + (high - low) * t;
}

/** How far a value lies along an interval of a scale. */
function along(scale, [low, high], value) {
  return scale.spacing === "log" ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low);
}

/** What users know a triangle by. */
const numberOf = (surface, triangle) => (surface.numbers.length ? surface.numbers[triangle] : triangle);
const channels = (code) => [(code >> 16) & 255, (code >> 8) & 255, code & 255];
