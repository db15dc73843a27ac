#version 300 es
// A disc with a rim, and a number in it; or a ring.
precision highp float;
flat in float vGlyph;
uniform float diameter;
uniform vec4 fill;
uniform vec4 rim;
uniform float hole;  // share of the radius that stays open
uniform float cells; // along a side of the numbers' image; 0: no numbers
uniform sampler2D numbers;
out vec4 color;

void main() {
  float r = length(gl_PointCoord - 0.5) * diameter;
  float radius = 0.5 * diameter - 0.5;
  float inside = clamp(radius - r + 0.5, 0.0, 1.0) * clamp(r - hole * radius + 0.5, 0.0, 1.0);
  float onRim = clamp(r - (radius - 1.6) + 0.5, 0.0, 1.0);
  vec4 c = mix(fill, rim, onRim);
  if (cells > 0.0) {
    vec2 cell = vec2(mod(vGlyph, cells), floor(vGlyph / cells));
    c.rgb = mix(c.rgb, rim.rgb, texture(numbers, (cell + gl_PointCoord) / cells).a);
  }
  float alpha = c.a * inside;
  if (alpha < 0.01) discard;
  color = vec4(c.rgb * alpha, alpha);
}
