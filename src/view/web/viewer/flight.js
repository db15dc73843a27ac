// Cameras that fly: angles, zoom and the point in the middle change over a moment.
const MOMENT = 650;

function newPilot(redraw) {
  let request = null;
  const stop = () => {
    if (request !== null) cancelAnimationFrame(request);
    request = null;
  };
  /** Leads a camera to the angles, the zoom and the focus of `goal`; angles take the shorter way round. */
  const fly = (camera, goal) => {
    stop();
    const start = { yaw: camera.yaw, pitch: camera.pitch, zoom: camera.zoom, pan: camera.pan };
    const end = { ...start, ...goal };
    end.yaw = start.yaw + Math.atan2(Math.sin(end.yaw - start.yaw), Math.cos(end.yaw - start.yaw));
    Object.assign(camera, { from: camera.focus, focus: goal.focus, blend: 0 });
    const begun = performance.now();
    const step = (now) => {
      const t = clamp((now - begun) / MOMENT, 0, 1);
      const s = t * t * (3 - 2 * t);
      camera.yaw = start.yaw + (end.yaw - start.yaw) * s;
      camera.pitch = start.pitch + (end.pitch - start.pitch) * s;
      camera.zoom = start.zoom * (end.zoom / start.zoom) ** s;
      camera.pan = scaled([...start.pan, 0], 1 - s).slice(0, 2);
      camera.blend = s;
      redraw();
      request = t < 1 ? requestAnimationFrame(step) : null;
    };
    request = requestAnimationFrame(step);
  };
  return { fly, stop };
}

/** Where to fly so that a triangle is seen head on, and large enough. */
function viewOf(surface, k, triangle) {
  const [p, q, r] = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map((weights) => pointOn(surface, triangle, weights)[surface.home]);
  const less = (a, b) => add(a, scaled(b, -1));
  const size = Math.max(Math.hypot(...less(q, p)), Math.hypot(...less(r, p)), 1e-3);
  const focus = { surface: k, triangle, places: middleOf(surface, triangle), elsewhere: new Map() };
  return { ...facing(unit(cross(less(q, p), less(r, p)))), focus, zoom: clamp(0.3 / size, 2, 40) };
}
