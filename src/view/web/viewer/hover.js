// The map made visible: the point under the pointer, and where it is on every other surface.

/** The point of a surface under the pointer in a panel; null beside it. */
function pointUnder(scene, panel, frame, x, y) {
  const surface = scene.surfaces[panel.surface];
  const hit = pick(surface, frame.slide, rayThrough(frame.matrices, panel, x, y));
  if (!hit) return null;
  const { triangle, weights, distance } = hit;
  const found = { panel, surface: panel.surface, triangle, weights, distance, patch: patchAt(surface, triangle, weights) };
  return { ...found, places: pointOn(surface, triangle, weights), elsewhere: new Map() };
}

/** Where a hovered point is in a panel; null if it has no image there. */
function placeIn(scene, panel, hover, slide) {
  const [here, there] = [scene.surfaces[hover.surface], scene.surfaces[panel.surface]];
  if (here.spaces.join() === there.spaces.join()) return mixed(hover.places[0], hover.places[1], slide);
  if (!hover.elsewhere.has(panel.surface)) hover.elsewhere.set(panel.surface, onOther(there, here, hover));
  const image = hover.elsewhere.get(panel.surface);
  return image && mixed(image[0], image[1], slide);
}

/** Through a plane that both surfaces share as their second space: the point of the other one at the same place. */
function onOther(there, here, hover) {
  if (here.spaces[1] === undefined || here.spaces[1] !== there.spaces[1]) return null;
  const [x, y] = hover.places[1];
  const hit = pick(there, 1, { start: [x, y, 4], way: [0, 0, -1] });
  return hit && pointOn(there, hit.triangle, hit.weights);
}

/** The mark under the pointer that the surface does not hide, if there is one. */
function markUnder(scene, panel, frame, x, y) {
  const near = marksOn(scene, panel.surface).map((mark) => {
    const place = mixed(mark.places[0], mark.places[1] ?? mark.places[0], frame.slide);
    const [u, v] = seenAt(frame.matrices, panel, place);
    return { mark, place, u, v, distance: Math.hypot(u - x, v - y) };
  });
  const found = near.filter(({ distance }) => distance < 13).sort((a, b) => a.distance - b.distance)
    .find((candidate) => !isHidden(scene.surfaces[panel.surface], panel, frame, candidate));
  return found ? { mark: found.mark, number: scene.marks.indexOf(found.mark) + 1 } : null;
}

/** True if a surface lies well before a point that appears at (u, v). */
function isHidden(surface, panel, frame, { place, u, v }) {
  const ray = rayThrough(frame.matrices, panel, u, v);
  const hit = pick(surface, frame.slide, ray);
  return hit !== null && hit.distance < Math.hypot(...add(place, scaled(ray.start, -1))) - 0.06;
}

/** What there is to say about a point, a line each. */
function wordsFor(scene, hover, found) {
  const lines = [];
  if (found) lines.push(`${scene.mark_name} ${found.number}: ${found.mark.name}`);
  if (hover) {
    const surface = scene.surfaces[hover.surface];
    const patch = hover.patch >= 0 ? `${scene.patch_names[hover.patch] ?? `${scene.patch_name} ${hover.patch}`}, ` : "";
    lines.push(`${patch}face ${numberOf(surface, hover.triangle)}`);
    if (surface.values.length) {
      const said = scene.scales.map((scale, k) => {
        const value = measured(scale, surface.values[3 * hover.triangle + k]);
        return Number.isNaN(value) ? null : `${scale.name.toLowerCase()} ${brief(value)}${scale.unit}`;
      });
      lines.push(said.filter((text) => text !== null).join(", ") || "no area");
    }
  }
  return lines.join("\n");
}

/** A number in three digits or so. */
function brief(value) {
  return value >= 100 ? value.toFixed(0) : value >= 10 ? value.toFixed(1) : value.toFixed(2);
}
