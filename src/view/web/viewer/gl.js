// Programs, buffers and textures.
function program(gl, name) {
  const made = gl.createProgram();
  for (const [kind, type] of [["vert", gl.VERTEX_SHADER], ["frag", gl.FRAGMENT_SHADER]]) {
    const shader = gl.createShader(type);
    gl.shaderSource(shader, document.getElementById(`${name}.${kind}`).textContent.trim());
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(`${name}.${kind}: ${gl.getShaderInfoLog(shader)}`);
    gl.attachShader(made, shader);
  }
  gl.linkProgram(made);
  if (!gl.getProgramParameter(made, gl.LINK_STATUS)) throw new Error(`${name}: ${gl.getProgramInfoLog(made)}`);
  const uniforms = {};
  const count = gl.getProgramParameter(made, gl.ACTIVE_UNIFORMS);
  for (let i = 0; i < count; i++) {
    const { name: uniform } = gl.getActiveUniform(made, i);
    uniforms[uniform] = gl.getUniformLocation(made, uniform);
  }
  return { made, uniforms };
}

/** Binds an array to an attribute of the vertex array at hand; `each`: once per instance. */
function attribute(gl, { made }, name, array, size, { normalised = false, each = false } = {}) {
  const at = gl.getAttribLocation(made, name);
  const types = new Map([
    [Float32Array, gl.FLOAT], [Int8Array, gl.BYTE], [Uint8Array, gl.UNSIGNED_BYTE], [Uint16Array, gl.UNSIGNED_SHORT],
  ]);
  if (at < 0) return;
  gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
  gl.bufferData(gl.ARRAY_BUFFER, array, gl.STATIC_DRAW);
  gl.enableVertexAttribArray(at);
  gl.vertexAttribPointer(at, size, types.get(array.constructor), normalised, 0, 0);
  gl.vertexAttribDivisor(at, each ? 1 : 0);
}

function texture(gl, source, { repeat = false, mipmaps = false, flip = false } = {}) {
  const made = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, made);
  gl.pixelStorei(gl.UNPACK_FLIP_Y_WEBGL, flip);
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, gl.RGBA, gl.UNSIGNED_BYTE, source);
  const wrap = repeat ? gl.REPEAT : gl.CLAMP_TO_EDGE;
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, wrap);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, wrap);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.LINEAR);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, mipmaps ? gl.LINEAR_MIPMAP_LINEAR : gl.LINEAR);
  if (mipmaps) gl.generateMipmap(gl.TEXTURE_2D);
  return made;
}

/** A row of colours between those of a scale. */
function rampTexture(gl, scale) {
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [256, 1];
  const pen = canvas.getContext("2d");
  const gradient = pen.createLinearGradient(0, 0, 256, 0);
  scale.ramp.forEach((code, i) => gradient.addColorStop(i / (scale.ramp.length - 1), `rgb(${channels(code)})`));
  pen.fillStyle = gradient;
  pen.fillRect(0, 0, 256, 1);
  return texture(gl, canvas);
}
