// Which point of a surface lies on a ray: every triangle is tried, which takes some milliseconds for the largest surfaces.
function pick(surface, slide, { start, way }) {
  const { corners, triangles } = surface;
  const [p, q] = surface.positions;
  let best = null;
  let nearest = Infinity;
  const at = (v, axis) => p[v + axis] + (q[v + axis] - p[v + axis]) * slide;
  for (let t = 0; t < triangles; t++) {
    const [a, b, c] = [3 * corners[3 * t], 3 * corners[3 * t + 1], 3 * corners[3 * t + 2]];
    const [ax, ay, az] = [at(a, 0), at(a, 1), at(a, 2)];
    const [ux, uy, uz] = [at(b, 0) - ax, at(b, 1) - ay, at(b, 2) - az];
    const [vx, vy, vz] = [at(c, 0) - ax, at(c, 1) - ay, at(c, 2) - az];
    const [hx, hy, hz] = [way[1] * vz - way[2] * vy, way[2] * vx - way[0] * vz, way[0] * vy - way[1] * vx];
    const volume = ux * hx + uy * hy + uz * hz;
    if (volume === 0) continue;
    const [sx, sy, sz] = [start[0] - ax, start[1] - ay, start[2] - az];
    const s = (sx * hx + sy * hy + sz * hz) / volume;
    if (!(s >= 0 && s <= 1)) continue;
    const [kx, ky, kz] = [sy * uz - sz * uy, sz * ux - sx * uz, sx * uy - sy * ux];
    const r = (way[0] * kx + way[1] * ky + way[2] * kz) / volume;
    if (!(r >= 0 && s + r <= 1)) continue;
    const distance = (vx * kx + vy * ky + vz * kz) / volume;
    if (distance > 1e-6 && distance < nearest) {
      nearest = distance;
      best = { triangle: t, weights: [1 - s - r, s, r], distance };
    }
  }
  return best;
}

/** The patch at a point of a triangle. */
function patchAt(surface, triangle, weights) {
  const { patches, partTriangles, partPatches, partCorners } = surface;
  if (!patches.length) return -1;
  if (patches[triangle] !== IN_PARTS) return patches[triangle];
  let [best, inside] = [-1, -Infinity];
  for (let i = 0; i < partTriangles.length; i++) {
    if (partTriangles[i] !== triangle) continue;
    const [a, b, c] = [0, 2, 4].map((k) => [partCorners[6 * i + k] / 65535, partCorners[6 * i + k + 1] / 65535]);
    const area = (p, q, r) => (q[0] - p[0]) * (r[1] - p[1]) - (r[0] - p[0]) * (q[1] - p[1]);
    const whole = area(a, b, c) || 1;
    const least = Math.min(area(weights, b, c) / whole, area(a, weights, c) / whole, area(a, b, weights) / whole);
    if (least > inside) [best, inside] = [partPatches[i], least];
  }
  return best;
}
