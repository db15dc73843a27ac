// The viewer: its state, and a frame whenever something changed.
function newState(scene) {
  return {
    mode: scene.modes[0], field: 0, slide: 1, wire: false, marks: true, lines: true, turned: true,
    isolines: scene.by_uv && !scene.texture, hover: null, cameras: newCameras(), ground: [1, 1, 1],
  };
}

function newViewer(scene, canvas, gl) {
  const state = newState(scene);
  const painter = newPainter(gl, scene);
  const elements = fillPanels(scene);
  const frames = new Map();
  let requested = false;
  const draw = () => {
    requested = false;
    measure(scene, canvas, elements);
    for (const panel of scene.panels) {
      if (panel.width < 1 || panel.height < 1) continue;
      frames.set(panel, frameOf(scene, state, panel));
      drawPanel(painter, state, panel, frames.get(panel));
    }
  };
  const redraw = () => {
    if (!requested) requestAnimationFrame(draw);
    requested = true;
  };
  const pilot = newPilot(redraw);
  const viewer = {
    scene, state, painter, draw, redraw,
    stopFlight: pilot.stop,
    distance: (panel) => fittingDistance(scene, panel),
    hoverAt(panel, x, y) {
      const frame = frames.get(panel);
      if (!frame) return;
      state.hover = pointUnder(scene, panel, frame, x, y);
      const found = state.marks ? markUnder(scene, panel, frame, x, y) : null;
      showTip(canvas, wordsFor(scene, state.hover, found), panel, x, y);
      redraw();
    },
    hoverEnd() {
      state.hover = null;
      showTip(canvas, "");
      redraw();
    },
    focusAt(panel, x, y) {
      const focus = pointUnder(scene, panel, frames.get(panel), x, y);
      const camera = cameraOf(state.cameras, panel);
      if (focus) pilot.fly(camera, { focus, zoom: Math.max(camera.zoom * 1.8, 1.8) });
    },
    flyTo(k, triangle) {
      pilot.fly(state.cameras.body, viewOf(scene.surfaces[k], k, triangle));
      document.getElementById("viewer").scrollIntoView({ behavior: "smooth", block: "start" });
    },
    reset() {
      pilot.stop();
      state.cameras = newCameras();
      redraw();
    },
    /** Where a point, given in the spaces of a panel's surface, appears in the panel: pixels from its upper left corner. */
    seen(k, places) {
      const [panel, frame] = [scene.panels[k], frames.get(scene.panels[k])];
      return seenAt(frame.matrices, panel, mixed(places[0], places[1] ?? places[0], frame.slide));
    },
  };
  scene.panels.forEach((panel) => Object.assign(panel, middleOfView(scene.surfaces[panel.surface], panel)));
  elements.forEach((element, k) => listen(viewer, scene.panels[k], element));
  return viewer;
}

function loadTexture(gl, { scene, painter, redraw }) {
  if (!scene.texture) return;
  const picture = new Image();
  picture.addEventListener("load", () => {
    painter.image = texture(gl, picture, { repeat: true, mipmaps: true, flip: true });
    redraw();
  });
  picture.src = scene.texture;
}

/** The colour behind the panels, which faded things fade to. */
function groundColor() {
  const [, r, g, b] = getComputedStyle(document.getElementById("stage")).backgroundColor.match(/(\d+)\D+(\d+)\D+(\d+)/);
  return [r, g, b].map((x) => Number(x) / 255);
}

function showFailure() {
  const failure = document.createElement("p");
  failure.className = "failure";
  failure.textContent = "This browser shows no WebGL 2. The numbers below need none.";
  document.getElementById("stage").replaceChildren(failure);
}

function main() {
  const scene = readScene();
  [HOME.yaw, HOME.pitch] = scene.home;
  fillHistograms(scene);
  const canvas = document.getElementById("canvas");
  const gl = canvas.getContext("webgl2", { antialias: true, alpha: true });
  if (!gl) {
    showFailure();
    return;
  }
  const viewer = newViewer(scene, canvas, gl);
  const { state, redraw } = viewer;
  const themed = () => {
    state.ground = groundColor();
    redraw();
  };
  fillModes(scene, state, redraw);
  fillToggles(scene, state, redraw);
  fillMorph(scene, state, redraw);
  fillFlips(scene, viewer.flyTo);
  document.getElementById("reset").addEventListener("click", viewer.reset);
  document.addEventListener("theme", themed);
  new ResizeObserver(redraw).observe(canvas);
  themed();
  viewer.draw();
  gl.finish();
  loadTexture(gl, viewer);
  // What tests, and the curious, look at.
  window.homeo = viewer;
  document.documentElement.dataset.firstFrame = Math.round(performance.now());
  document.documentElement.dataset.ready = "true";
}

main();
