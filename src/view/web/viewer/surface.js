// A surface as the graphics card takes it: single triangles, those on a border of patches divided into parts.
function normalsAt({ corners, triangles }, positions) {
  const normals = new Float32Array(positions.length);
  for (let i = 0; i < 3 * triangles; i += 3) {
    const [a, b, c] = [3 * corners[i], 3 * corners[i + 1], 3 * corners[i + 2]];
    const [ux, uy, uz] = [positions[b] - positions[a], positions[b + 1] - positions[a + 1], positions[b + 2] - positions[a + 2]];
    const [vx, vy, vz] = [positions[c] - positions[a], positions[c + 1] - positions[a + 1], positions[c + 2] - positions[a + 2]];
    const [x, y, z] = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
    for (const v of [a, b, c]) {
      normals[v] += x;
      normals[v + 1] += y;
      normals[v + 2] += z;
    }
  }
  for (let v = 0; v < normals.length; v += 3) {
    const length = Math.hypot(normals[v], normals[v + 1], normals[v + 2]) || 1;
    for (let k = 0; k < 3; k++) normals[v + k] /= length;
  }
  return normals;
}

const WHOLE = [1, 0, 0, 0, 1, 0, 0, 0, 1];

/** Calls `take(triangle, patch, weights)` for every triangle that is drawn; weights are nine, corner by corner. */
function eachDrawn(surface, take) {
  const { triangles, patches, partTriangles, partPatches, partCorners } = surface;
  for (let t = 0; t < triangles; t++) {
    const patch = patches.length ? patches[t] : 0;
    if (patch !== IN_PARTS) take(t, patch, WHOLE);
  }
  const weights = new Array(9);
  for (let i = 0; i < partTriangles.length; i++) {
    for (let k = 0; k < 3; k++) {
      const [a, b] = [partCorners[6 * i + 2 * k] / 65535, partCorners[6 * i + 2 * k + 1] / 65535];
      [weights[3 * k], weights[3 * k + 1], weights[3 * k + 2]] = [a, b, Math.max(1 - a - b, 0)];
    }
    take(partTriangles[i], partPatches[i], weights);
  }
}

function countDrawn(surface) {
  let count = 0;
  eachDrawn(surface, () => count++);
  return count;
}

/** The arrays of all attributes. */
function expanded(surface, colors) {
  const { corners, positions, uv, values, turned } = surface;
  const count = 3 * countDrawn(surface);
  const normals = positions[0] === positions[1] ? [normalsAt(surface, positions[0])] : positions.map((p) => normalsAt(surface, p));
  const out = {
    position0: new Float32Array(3 * count), position1: new Float32Array(3 * count),
    normal0: new Int8Array(4 * count), normal1: new Int8Array(4 * count), uv: new Float32Array(2 * count),
    corner: new Uint8Array(4 * count), paint: new Uint8Array(4 * count), values: new Uint16Array(4 * count),
  };
  let at = 0;
  eachDrawn(surface, (t, patch, weights) => {
    const [r, g, b] = colors.length ? channels(colors[patch % colors.length]) : [200, 198, 190];
    for (let k = 0; k < 3; k++, at++) {
      for (let j = 0; j < 3; j++) {
        const [w, v] = [weights[3 * k + j], 3 * corners[3 * t + j]];
        if (w === 0) continue;
        for (let axis = 0; axis < 3; axis++) {
          out.position0[3 * at + axis] += w * positions[0][v + axis];
          out.position1[3 * at + axis] += w * positions[1][v + axis];
          out.normal0[4 * at + axis] += Math.round(127 * w * normals[0][v + axis]);
          out.normal1[4 * at + axis] += Math.round(127 * w * (normals[1] ?? normals[0])[v + axis]);
        }
        if (uv) {
          out.uv[2 * at] += w * uv[6 * t + 2 * j];
          out.uv[2 * at + 1] += w * uv[6 * t + 2 * j + 1];
        }
        out.corner[4 * at + j] = Math.round(255 * w);
      }
      if (!uv) out.uv[2 * at] = -1e6;
      out.corner[4 * at + 3] = turned.has(t) ? 255 : 0;
      out.paint.set([r, g, b, 255], 4 * at);
      out.values.set([values[3 * t], values[3 * t + 1], values[3 * t + 2], patch], 4 * at);
    }
  });
  return { out, count };
}

function uploadSurface(gl, shader, surface, colors) {
  const { out, count } = expanded(surface, colors);
  const vao = gl.createVertexArray();
  gl.bindVertexArray(vao);
  attribute(gl, shader, "position0", out.position0, 3);
  attribute(gl, shader, "position1", out.position1, 3);
  attribute(gl, shader, "normal0", out.normal0, 4, { normalised: true });
  attribute(gl, shader, "normal1", out.normal1, 4, { normalised: true });
  attribute(gl, shader, "uv", out.uv, 2);
  attribute(gl, shader, "corner", out.corner, 4, { normalised: true });
  attribute(gl, shader, "paint", out.paint, 4, { normalised: true });
  attribute(gl, shader, "values", out.values, 4, { normalised: true });
  return { vao, count };
}

/** The unit square of texture coordinates, just behind the plane. */
function backdrop() {
  const square = Float32Array.from([-1, -1, -0.004, 1, -1, -0.004, 1, 1, -0.004, -1, 1, -0.004]);
  return {
    corners: [0, 1, 2, 0, 2, 3], triangles: 2, positions: [square, square], values: new Uint16Array(6), patches: [],
    partTriangles: [], partPatches: [], partCorners: [], turned: new Set(),
    uv: Float32Array.from([0, 0, 1, 0, 1, 1, 0, 0, 1, 1, 0, 1]),
  };
}
