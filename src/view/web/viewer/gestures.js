// Turn, move, zoom: with a mouse, a wheel, or fingers. One finger or the left button turns, two or another button move.
function listen(viewer, panel, element) {
  const pointers = new Map();
  const camera = () => cameraOf(viewer.state.cameras, panel);
  const at = (event) => {
    const box = element.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  const zoom = (factor) => (camera().zoom = clamp(camera().zoom * factor, 0.4, 400));
  const move = (dx, dy) => panBy(camera(), panel, viewer.distance(panel), dx, dy);
  const turn = (dx, dy) => {
    camera().yaw += dx * 0.009;
    camera().pitch = clamp(camera().pitch + dy * 0.009, -1.5, 1.5);
  };

  element.addEventListener("pointerdown", (event) => {
    element.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, at(event));
    viewer.stopFlight();
    if (event.pointerType !== "mouse") viewer.hoverAt(panel, ...at(event));
  });
  element.addEventListener("pointermove", (event) => {
    const now = at(event);
    const before = pointers.get(event.pointerId);
    if (!before) {
      viewer.hoverAt(panel, ...now);
      return;
    }
    const [dx, dy] = [now[0] - before[0], now[1] - before[1]];
    if (pointers.size === 1) {
      const moves = panel.flat || event.shiftKey || (event.buttons & 6) !== 0;
      if (moves) move(dx, dy);
      else turn(dx, dy);
    } else {
      const [, other] = [...pointers].find(([id]) => id !== event.pointerId);
      const length = (p) => Math.max(Math.hypot(p[0] - other[0], p[1] - other[1]), 10);
      zoom(length(now) / length(before));
      move(dx / 2, dy / 2);
    }
    pointers.set(event.pointerId, now);
    viewer.redraw();
  });
  const end = (event) => pointers.delete(event.pointerId);
  element.addEventListener("pointerup", end);
  element.addEventListener("pointercancel", end);
  element.addEventListener("pointerleave", () => pointers.size === 0 && viewer.hoverEnd());
  element.addEventListener("contextmenu", (event) => event.preventDefault());
  element.addEventListener("wheel", (event) => {
    event.preventDefault();
    zoom(Math.exp(-clamp(event.deltaY, -120, 120) * 0.0022));
    viewer.redraw();
  }, { passive: false });
  element.addEventListener("dblclick", (event) => viewer.focusAt(panel, ...at(event)));
}
