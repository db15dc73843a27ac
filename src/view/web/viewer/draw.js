// One frame: every panel with its surface, lines and dots.
const MODES = ["patches", "distortion", "checker", "texture", "places", "plain"];
const DISC_INK = [0.12, 0.15, 0.2, 0.92];
const WHITE = [1, 1, 1, 1];
const RED = [0.84, 0.07, 0.16, 1];
const POINT = [1, 0.83, 0.1, 1];
const LIFT = 0.012;
const PLANE_LIFT = 0.002;

function newPainter(gl, scene) {
  const shaders = { surface: program(gl, "surface"), line: program(gl, "line"), dot: program(gl, "dot") };
  const surfaces = scene.surfaces.map((s) => uploadSurface(gl, shaders.surface, s, scene.patch_colors));
  const needsBackdrop = scene.panels.some((panel) => panel.backdrop);
  const painter = {
    gl, scene, shaders, surfaces,
    lines: scene.surfaces.map((s) => uploadLines(gl, shaders.line, s)),
    marks: scene.surfaces.map((_, k) => uploadDots(gl, shaders.dot, marksOn(scene, k).map((m) => m.places))),
    turned: scene.surfaces.map((s) => uploadDots(gl, shaders.dot, s.flips.map((t) => middleOf(s, t)))),
    backdrop: needsBackdrop ? uploadSurface(gl, shaders.surface, backdrop(), []) : null,
    numbers: numberTexture(gl, scene.marks.length),
    ramps: scene.scales.map((scale) => rampTexture(gl, scale)),
    image: texture(gl, new ImageData(new Uint8ClampedArray([200, 200, 200, 255]), 1, 1)),
    point: gl.createVertexArray(),
  };
  gl.enable(gl.DEPTH_TEST);
  gl.depthFunc(gl.LEQUAL);
  gl.enable(gl.BLEND);
  gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
  gl.enable(gl.SCISSOR_TEST);
  return painter;
}

/** The marks that are shown on a surface: all, if it has the spaces that they have places in. */
function marksOn(scene, k) {
  return scene.surfaces[k].spaces.join() === scene.surfaces[0].spaces.join() ? scene.marks : [];
}

function useShader(painter, name, frame, slide) {
  const { made, uniforms } = painter.shaders[name];
  painter.gl.useProgram(made);
  painter.gl.uniformMatrix4fv(uniforms.view, false, frame.matrices.view);
  painter.gl.uniformMatrix4fv(uniforms.projection, false, frame.matrices.projection);
  painter.gl.uniform1f(uniforms.slide, slide);
  return uniforms;
}

function drawSurface(painter, state, panel, frame, { vao, count }, isBackdrop) {
  const { gl, scene } = painter;
  const u = useShader(painter, "surface", frame, isBackdrop ? 0 : frame.slide);
  const scale = scene.scales[state.field];
  const mode = isBackdrop ? "texture" : state.mode;
  gl.uniform1i(u.mode, MODES.indexOf(mode));
  gl.uniform1i(u.field, state.field);
  gl.uniform2f(u.ends, ...scale.ends.map((x) => along(scale, scale.range, x)));
  gl.uniform1i(u.byUv, scene.by_uv);
  gl.uniform1i(u.isolines, state.isolines && !isBackdrop);
  gl.uniform1i(u.wire, state.wire && !isBackdrop);
  gl.uniform1i(u.showTurned, state.turned);
  gl.uniform1f(u.light, panel.flat ? 0 : mode === "distortion" ? 0.7 : mode === "texture" ? 0.85 : 1);
  gl.uniform1f(u.fade, isBackdrop ? 0.45 : 0);
  gl.uniform1f(u.hovered, state.hover && mode === "patches" ? state.hover.patch : -1);
  gl.uniform3f(u.ground, ...state.ground);
  gl.activeTexture(gl.TEXTURE0);
  gl.bindTexture(gl.TEXTURE_2D, painter.ramps[state.field]);
  gl.uniform1i(u.ramp, 0);
  gl.activeTexture(gl.TEXTURE1);
  gl.bindTexture(gl.TEXTURE_2D, painter.image);
  gl.uniform1i(u.image, 1);
  gl.bindVertexArray(vao);
  gl.drawArrays(gl.TRIANGLES, 0, count);
}

function drawLines(painter, state, panel, frame, { vao, count }) {
  const { gl } = painter;
  const u = useShader(painter, "line", frame, frame.slide);
  gl.uniform2f(u.size, panel.width, panel.height);
  gl.uniform1f(u.width, 1.6);
  gl.uniform1f(u.lift, panel.flat ? PLANE_LIFT : LIFT * 0.6);
  gl.uniform4f(u.ink, 0.1, 0.12, 0.16, state.mode === "patches" ? 0.85 : 0.28);
  gl.bindVertexArray(vao);
  gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, count);
}

function drawDots(painter, panel, frame, { vao, count }, look) {
  const { gl, numbers } = painter;
  const u = useShader(painter, "dot", frame, frame.slide);
  const { fill, rim = WHITE, size, hole = 0, lift = LIFT, numbered = false } = look;
  gl.uniform1f(u.diameter, size * frame.density);
  gl.uniform1f(u.lift, panel.flat ? PLANE_LIFT : lift);
  gl.uniform4f(u.fill, ...fill);
  gl.uniform4f(u.rim, ...rim);
  gl.uniform1f(u.hole, hole);
  gl.uniform1f(u.cells, numbered ? numbers.cells : 0);
  gl.activeTexture(gl.TEXTURE0);
  gl.bindTexture(gl.TEXTURE_2D, numbers.image);
  gl.uniform1i(u.numbers, 0);
  gl.bindVertexArray(vao);
  gl.drawArrays(gl.POINTS, 0, count);
}

/** Few landmarks get large numbers, many get dots, and all are smaller in small panels. */
function markLook(count, { width }) {
  const size = count <= 30 ? 19 : count <= 70 ? 16 : 8;
  return { fill: DISC_INK, size: size * clamp(width / 380, 0.72, 1), numbered: count <= 70, lift: 0.06 };
}

/** The point under the pointer and its images; faint where the surface hides it. */
function drawPoint(painter, panel, frame, place) {
  const { gl, shaders } = painter;
  gl.bindVertexArray(painter.point);
  gl.disableVertexAttribArray(gl.getAttribLocation(shaders.dot.made, "place0"));
  for (const name of ["place0", "place1"]) gl.vertexAttrib3f(gl.getAttribLocation(shaders.dot.made, name), ...place);
  const dots = { vao: painter.point, count: 1 };
  gl.disable(gl.DEPTH_TEST);
  drawDots(painter, panel, frame, dots, { fill: [1, 0.83, 0.1, 0.35], rim: [0.1, 0.1, 0.1, 0.45], size: 13, hole: 0.4 });
  gl.enable(gl.DEPTH_TEST);
  drawDots(painter, panel, frame, dots, { fill: POINT, rim: [0.08, 0.09, 0.12, 1], size: 15, lift: 0.03 });
}

function drawPanel(painter, state, panel, frame) {
  const { gl, scene } = painter;
  const k = panel.surface;
  gl.viewport(...frame.box);
  gl.scissor(...frame.box);
  gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  if (panel.backdrop && scene.texture) drawSurface(painter, state, panel, frame, painter.backdrop, true);
  drawSurface(painter, state, panel, frame, painter.surfaces[k], false);
  if (state.lines && painter.lines[k].count) drawLines(painter, state, panel, frame, painter.lines[k]);
  if (state.turned && painter.turned[k].count) drawDots(painter, panel, frame, painter.turned[k], { fill: RED, size: 8 });
  const marks = painter.marks[k];
  if (state.marks && marks.count) drawDots(painter, panel, frame, marks, markLook(marks.count, panel));
  const place = state.hover && placeIn(scene, panel, state.hover, frame.slide);
  if (place) drawPoint(painter, panel, frame, place);
}
