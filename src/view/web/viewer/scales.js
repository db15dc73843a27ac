// Colour scales with what lies how often on them.
const SVG = new DOMParser().parseFromString("<svg></svg>", "text/html").querySelector("svg").namespaceURI;
const BINS = 48;

function svg(name, attributes, text) {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  if (text !== undefined) made.textContent = text;
  return made;
}

/** Shares of the surfaces' area by bins of a scale; what lies beyond its ends is in the outermost bins. */
function shares(scene, field) {
  const scale = scene.scales[field];
  const bins = new Float64Array(BINS);
  let all = 0;
  for (const surface of scene.surfaces) {
    for (let t = 0; t < surface.values.length / 3; t++) {
      const value = measured(scale, surface.values[3 * t + field]);
      if (Number.isNaN(value)) continue;
      const area = areaOf(surface, t);
      bins[clamp(Math.floor(along(scale, scale.ends, value) * BINS), 0, BINS - 1)] += area;
      all += area;
    }
  }
  return bins.map((x) => x / (all || 1));
}

/** Twice a triangle's area in the space where its surface is at home. */
function areaOf({ corners, positions, home }, t) {
  const at = positions[home];
  const p = [0, 1, 2].map((j) => {
    const v = 3 * corners[3 * t + j];
    return [at[v], at[v + 1], at[v + 2]];
  });
  const less = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
  return Math.hypot(...cross(less(p[1], p[0]), less(p[2], p[0])));
}

function colorAt(scale, t) {
  const at = clamp(t, 0, 1) * (scale.ramp.length - 1);
  const i = Math.min(Math.floor(at), scale.ramp.length - 2);
  return `rgb(${mixed(channels(scale.ramp[i]), channels(scale.ramp[i + 1]), at - i).map(Math.round)})`;
}

/** The picture of a scale: bars over a band of its colours, with ticks. */
function scalePicture(scene, field, width, height) {
  const scale = scene.scales[field];
  const bins = shares(scene, field);
  const [side, band, foot] = [24, 9, 18];
  const room = height - band - foot;
  const step = (width - 2 * side) / BINS;
  const most = Math.max(...bins, 1e-9);
  const picture = svg("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": `${scale.name}: ${scale.about}` });
  for (let i = 0; i < BINS; i++) {
    const [x, tall] = [side + i * step, (bins[i] / most) * (room - 2)];
    const color = colorAt(scale, (i + 0.5) / BINS);
    const bar = svg("rect", { x: x + 0.5, y: room - tall, width: step - 1, height: tall, rx: 1, fill: color });
    bar.append(svg("title", {}, `${(bins[i] * 100).toFixed(1)} % of the area`));
    picture.append(bar, svg("rect", { x, y: room + 1, width: step + 0.5, height: band, fill: color }));
  }
  for (const tick of scale.ticks) {
    const x = side + along(scale, scale.ends, tick) * (width - 2 * side);
    const open = tick === scale.ends[1] ? "\u2265\u2009" : tick === scale.ends[0] && tick > 0 ? "\u2264\u2009" : "";
    picture.append(svg("text", { x, y: height - 4, "text-anchor": "middle" }, `${open}${tick}${scale.unit}`));
  }
  return picture;
}

function fillHistograms(scene) {
  const place = document.getElementById("histograms");
  if (!place || !scene.surfaces.some((s) => s.values.length)) return;
  scene.scales.forEach((scale, field) => {
    const block = document.createElement("div");
    const [title, about] = [document.createElement("h3"), document.createElement("p")];
    title.textContent = scale.name;
    about.textContent = scale.about;
    block.append(title, scalePicture(scene, field, 360, 96), about);
    place.append(block);
  });
}

function showLegend(scene, state) {
  const place = document.getElementById("legend");
  const words = {
    patches: scene.patch_name === "patch" ? "Equal colours are the same patch of the layout" : "Every region has its colour",
    checker: "The same squares on all: where they are stretched, the map stretches",
    texture: scene.panels.some((p) => p.at === "slider") ? "The source's image, carried by the map" : "The image on the surface",
    places: "Equal colours are the same point: the colour says where it lies on the source",
    plain: "",
  };
  place.replaceChildren(state.mode === "distortion" ? scalePicture(scene, state.field, 420, 54) : words[state.mode]);
}
