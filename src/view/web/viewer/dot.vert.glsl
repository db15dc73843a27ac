#version 300 es
// A disc of constant size in pixels at a point, a little before the surface that it lies on.
in vec3 place0;
in vec3 place1;
in float glyph;
uniform mat4 view;
uniform mat4 projection;
uniform float slide;
uniform float diameter; // pixels
uniform float lift;
flat out float vGlyph;

void main() {
  vec4 at = view * vec4(mix(place0, place1, slide), 1.0);
  vec4 clip = projection * at;
  vec4 lifted = projection * (at + vec4(0.0, 0.0, lift, 0.0));
  gl_Position = vec4(clip.xy, lifted.z / lifted.w * clip.w, clip.w);
  gl_PointSize = diameter;
  vGlyph = glyph;
}
