// Buttons and sliders.
const MODE_NAMES = {
  patches: (scene) => (scene.patch_name === "patch" ? "Patches" : "Regions"),
  distortion: () => "Distortion", checker: () => "Checker", texture: () => "Texture", places: () => "Places", plain: () => "Plain",
};

/** A row of buttons of which one is on. */
function segments(place, names, chosen, choose) {
  place.replaceChildren();
  names.forEach(([key, name]) => {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = name;
    button.dataset.key = key;
    button.setAttribute("role", "radio");
    button.setAttribute("aria-checked", key === chosen);
    button.addEventListener("click", () => {
      place.querySelectorAll("button").forEach((b) => b.setAttribute("aria-checked", b === button));
      choose(key);
    });
    place.append(button);
  });
}

function fillToggles(scene, state, redraw) {
  const plural = scene.mark_name[0].toUpperCase() + scene.mark_name.slice(1) + "s";
  const all = [
    ["marks", plural, scene.marks.length > 0],
    ["lines", scene.by_uv ? "Borders" : "Arcs", scene.surfaces.some((s) => s.lines.length > 0)],
    ["isolines", "Isolines", scene.by_uv],
    ["wire", "Wireframe", true],
    ["turned", "Turned over", scene.surfaces.some((s) => s.flips.length > 0)],
  ];
  const place = document.getElementById("toggles");
  for (const [key, name, isThere] of all) {
    if (!isThere) continue;
    const label = document.createElement("label");
    const box = document.createElement("input");
    box.type = "checkbox";
    box.id = `toggle-${key}`;
    box.checked = state[key];
    box.addEventListener("change", () => {
      state[key] = box.checked;
      redraw();
    });
    label.append(box, name);
    place.append(label);
  }
}

function fillModes(scene, state, redraw) {
  const fields = document.getElementById("fields");
  const update = () => {
    fields.hidden = state.mode !== "distortion";
    showLegend(scene, state);
    redraw();
  };
  const modes = scene.modes.map((mode) => [mode, MODE_NAMES[mode](scene)]);
  segments(document.getElementById("modes"), modes, state.mode, (mode) => {
    state.mode = mode;
    update();
  });
  const names = scene.scales.map((scale, k) => [String(k), scale.name]);
  segments(fields, names, String(state.field), (k) => {
    state.field = Number(k);
    update();
  });
  update();
}

/** The slider between the spaces, and the button that lets it run to and fro. */
function fillMorph(scene, state, redraw) {
  if (!scene.panels.some((panel) => panel.at === "slider")) return;
  const [slider, play] = [document.getElementById("slide"), document.getElementById("play")];
  document.getElementById("morph").hidden = false;
  let running = null;
  const show = (on) => {
    play.textContent = on ? "\u275a\u275a" : "\u25b6";
    play.setAttribute("aria-label", on ? "Pause" : "Play");
  };
  const stop = () => {
    if (running !== null) cancelAnimationFrame(running.request);
    running = null;
    show(false);
  };
  const step = (now) => {
    const phase = ((now - running.start) / 6000 + running.phase) % 1;
    const swing = 0.5 - 0.5 * Math.cos(2 * Math.PI * phase);
    state.slide = clamp(1.08 * swing - 0.04, 0, 1);
    slider.value = state.slide;
    redraw();
    running.request = requestAnimationFrame(step);
  };
  slider.addEventListener("input", () => {
    stop();
    state.slide = Number(slider.value);
    redraw();
  });
  play.addEventListener("click", () => {
    if (running !== null) {
      stop();
      return;
    }
    running = { start: performance.now(), phase: Math.acos(clamp(1 - 2 * state.slide, -1, 1)) / (2 * Math.PI) };
    running.request = requestAnimationFrame(step);
    show(true);
  });
}
