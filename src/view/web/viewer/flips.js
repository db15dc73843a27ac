// The triangles that are collapsed or turned over, as buttons that fly to them.
const LISTED = 200;

function fillFlips(scene, fly) {
  const place = document.getElementById("flips");
  if (!place) return;
  const element = (name, text) => {
    const made = document.createElement(name);
    made.textContent = text;
    return made;
  };
  if (scene.surfaces.every((s) => s.flips.length === 0)) {
    place.append(element("p", "None."));
    return;
  }
  scene.surfaces.forEach((surface, k) => {
    if (surface.flips.length === 0) return;
    const list = document.createElement("div");
    list.className = "list";
    for (const triangle of surface.flips.slice(0, LISTED)) {
      const button = element("button", numberOf(surface, triangle));
      button.type = "button";
      button.title = "Fly there";
      button.addEventListener("click", () => fly(k, triangle));
      list.append(button);
    }
    const more = surface.flips.length > LISTED ? `, the first ${LISTED} of them` : "";
    place.append(element("h3", `${surface.name}: ${surface.flips.length}, by face${more}`), list);
  });
}
