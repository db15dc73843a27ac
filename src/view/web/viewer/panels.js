// The panels' places on the page, and what follows from them for a frame.
const SLIDES = { first: 0, second: 1 };

function fillPanels(scene) {
  const place = document.getElementById("panels");
  place.className = ["one", "two", "three", "four"][scene.panels.length - 1];
  return scene.panels.map((panel) => {
    const element = document.createElement("div");
    element.className = "panel";
    const name = document.createElement("div");
    name.className = "name";
    const [title, more] = [document.createElement("b"), document.createElement("span")];
    [title.textContent, more.textContent] = [panel.title, panel.subtitle];
    name.append(title, more);
    element.append(name);
    place.append(element);
    return element;
  });
}

/** Fits the canvas to the page, and tells every panel its size, and its box on the canvas from the lower left corner. */
function measure(scene, canvas, elements) {
  const density = Math.min(devicePixelRatio || 1, 2);
  const outer = canvas.getBoundingClientRect();
  const [width, height] = [Math.round(outer.width * density), Math.round(outer.height * density)];
  if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
  scene.panels.forEach((panel, k) => {
    const box = elements[k].getBoundingClientRect();
    const [left, low] = [box.left - outer.left, outer.bottom - box.bottom];
    const pixels = [left, low, box.width, box.height].map((x) => Math.round(x * density));
    Object.assign(panel, { width: box.width, height: box.height, left, top: box.top - outer.top, box: pixels, density });
  });
}

/** What a frame of a panel is drawn with. */
function frameOf(scene, state, panel) {
  const slide = SLIDES[panel.at] ?? state.slide;
  const camera = cameraOf(state.cameras, panel);
  const at = (point) => (point && placeIn(scene, panel, point, slide)) || panel.middle;
  const focus = mixed(at(camera.from), at(camera.focus), camera.blend ?? 1);
  const matrices = matricesOf(camera, panel, fittingDistance(scene, panel), focus);
  return { matrices, slide, box: panel.box, density: panel.density };
}

/** Words beside the pointer, within the canvas. */
function showTip(canvas, words, panel, x, y) {
  const tip = document.getElementById("tip");
  tip.hidden = !words;
  if (!words) return;
  tip.textContent = words;
  const right = panel.left + x + 16;
  const left = right + tip.offsetWidth > canvas.clientWidth ? panel.left + x - 12 - tip.offsetWidth : right;
  const lowest = Math.max(canvas.clientHeight - tip.offsetHeight - 4, 4);
  tip.style.left = `${Math.max(left, 4)}px`;
  tip.style.top = `${clamp(panel.top + y + 14, 4, lowest)}px`;
}
