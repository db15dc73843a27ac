// Lines on surfaces, a strip for every piece.
function uploadLines(gl, shader, surface) {
  const names = [["start0", "end0"], ["start1", "end1"]];
  const count = surface.lines.reduce((sum, points) => sum + Math.max(points - 1, 0), 0);
  const vao = gl.createVertexArray();
  gl.bindVertexArray(vao);
  surface.linePoints.forEach((points, space) => {
    const ends = [new Float32Array(3 * count), new Float32Array(3 * count)];
    let [at, first] = [0, 0];
    for (const length of surface.lines) {
      for (let i = first; i + 1 < first + length; i++, at++) {
        ends[0].set(points.subarray(3 * i, 3 * i + 3), 3 * at);
        ends[1].set(points.subarray(3 * i + 3, 3 * i + 6), 3 * at);
      }
      first += length;
    }
    ends.forEach((array, k) => attribute(gl, shader, names[space][k], array, 3, { each: true }));
  });
  return { vao, count };
}
