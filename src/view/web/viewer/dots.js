// Points on surfaces: numbered landmarks, triangles that are turned over, the point under the pointer.
const NUMBER_CELL = 64;

/** An image of the numbers from 1 on, in a square of cells. */
function numberTexture(gl, count) {
  const cells = Math.max(Math.ceil(Math.sqrt(count)), 1);
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = Math.min(cells * NUMBER_CELL, 2048);
  const cell = canvas.width / cells;
  const pen = canvas.getContext("2d");
  [pen.textAlign, pen.textBaseline, pen.fillStyle] = ["center", "alphabetic", "#fff"];
  for (let i = 0; i < count; i++) {
    const text = String(i + 1);
    pen.font = `650 ${cell * (text.length > 2 ? 0.42 : 0.56)}px system-ui, sans-serif`;
    const box = pen.measureText(text);
    const middle = (box.actualBoundingBoxAscent - box.actualBoundingBoxDescent) / 2;
    pen.fillText(text, ((i % cells) + 0.5) * cell, (Math.floor(i / cells) + 0.5) * cell + middle);
  }
  return { image: texture(gl, canvas, { mipmaps: true }), cells };
}

/** Points given by their places in both spaces. */
function uploadDots(gl, shader, points) {
  const vao = gl.createVertexArray();
  gl.bindVertexArray(vao);
  attribute(gl, shader, "place0", Float32Array.from(points.flatMap((p) => p[0])), 3);
  attribute(gl, shader, "place1", Float32Array.from(points.flatMap((p) => p[1] ?? p[0])), 3);
  attribute(gl, shader, "glyph", Float32Array.from(points, (_, i) => i), 1);
  return { vao, count: points.length };
}

/** The middle of a triangle in both spaces. */
function middleOf(surface, triangle) {
  return pointOn(surface, triangle, [1 / 3, 1 / 3, 1 / 3]);
}

/** A point of a triangle in both spaces. */
function pointOn({ corners, positions }, triangle, weights) {
  return positions.map((at) => {
    const sum = [0, 0, 0];
    for (let j = 0; j < 3; j++) {
      const v = 3 * corners[3 * triangle + j];
      for (let axis = 0; axis < 3; axis++) sum[axis] += weights[j] * at[v + axis];
    }
    return sum;
  });
}
