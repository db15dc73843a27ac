#version 300 es
// The colour of a surface: what is shown, under a light at the viewer's shoulder, with the triangles' edges over it.
precision highp float;
precision highp int;
in vec3 vNormal;
in vec3 vPlace;
in vec2 vUv;
in vec3 vCorner;
in vec3 vPaint;
flat in vec3 vValues;
flat in float vPatch;
flat in float vTurned;
uniform int mode;       // 0 patches, 1 distortion, 2 checker, 3 texture, 4 places, 5 plain
uniform int field;      // the measure
uniform vec2 ends;      // where the scale's colours begin and end, in steps of the measure's range
uniform sampler2D ramp;
uniform sampler2D image;
uniform bool byUv;
uniform bool isolines;
uniform bool wire;
uniform bool showTurned;
uniform float light;    // how much shading shows
uniform float fade;     // towards the ground: 0 not at all
uniform float hovered;  // the patch under the pointer, or -1
uniform vec3 ground;
out vec4 color;

const vec3 PLAIN = vec3(0.78, 0.77, 0.74);
const vec3 MISSING = vec3(0.62, 0.64, 0.67);
const vec3 TURNED = vec3(0.84, 0.07, 0.16);
const vec3 INK = vec3(0.10, 0.12, 0.16);

// From one square to the next it goes from -1 to 1, within a pixel.
float wave(float x) {
  return clamp(sin(3.14159265 * x) / (2.2 * fwidth(x) + 1e-6), -1.0, 1.0);
}

// Squares of about an eighth of the surface, turned so that no plane of theirs is parallel to an axis.
float squares() {
  if (byUv) return 0.5 + 0.5 * wave(vUv.x * 16.0) * wave(vUv.y * 16.0);
  const mat3 TURN = mat3(0.80, 0.36, -0.48, -0.60, 0.48, -0.64, 0.0, 0.80, 0.60);
  vec3 at = TURN * vPlace * 7.0;
  return 0.5 + 0.5 * wave(at.x) * wave(at.y) * wave(at.z);
}

vec3 distortion() {
  float value = field == 0 ? vValues.x : field == 1 ? vValues.y : vValues.z;
  if (value > 0.999995) return MISSING;
  return texture(ramp, vec2(clamp((value - ends.x) / (ends.y - ends.x), 0.0, 1.0) * 0.996 + 0.002, 0.5)).rgb;
}

vec3 shown() {
  bool hasUv = vUv.x > -1e5;
  if (mode == 0) return hovered < 0.0 ? vPaint : vPatch == hovered ? mix(vPaint, vec3(1.0), 0.35) : vPaint * 0.88;
  if (mode == 1) return distortion();
  if (mode == 2) return byUv && !hasUv ? MISSING : mix(vec3(0.96, 0.95, 0.92), vec3(0.22, 0.42, 0.63), squares());
  if (mode == 3) return hasUv ? texture(image, vUv).rgb : MISSING;
  if (mode == 4) return 0.12 + 0.82 * clamp(vPlace * 0.62 + 0.5, 0.0, 1.0);
  return PLAIN;
}

vec3 lit(vec3 base, vec3 n) {
  const vec3 KEY = vec3(-0.362, 0.588, 0.724);
  float shade = 0.50 + 0.08 * n.y + 0.40 * max(dot(n, KEY), 0.0) + 0.18 * max(n.z, 0.0);
  float gleam = 0.10 * pow(max(dot(reflect(-KEY, n), vec3(0.0, 0.0, 1.0)), 0.0), 20.0);
  return pow(pow(base, vec3(2.2)) * mix(1.0, shade, light), vec3(1.0 / 2.2)) + gleam * light;
}

float nearLine(float at, float count) {
  float x = at * count;
  float width = fwidth(x);
  float room = 1.0 - smoothstep(0.12, 0.4, width);
  return room * (1.0 - smoothstep(0.35 * width, 1.1 * width, abs(x - floor(x + 0.5))));
}

void main() {
  vec3 base = shown();
  if (showTurned && vTurned > 0.5) base = TURNED;
  vec3 n = dot(vNormal, vNormal) > 0.0 ? normalize(vNormal) : vec3(0.0, 0.0, 1.0);
  if (!gl_FrontFacing) n = -n;
  vec3 c = lit(base, n);
  if (!gl_FrontFacing && light > 0.0 && !(showTurned && vTurned > 0.5)) c *= 0.62;
  if (isolines && vUv.x > -1e5) c = mix(c, INK, 0.6 * max(nearLine(vUv.x, 10.0), nearLine(vUv.y, 10.0)));
  if (wire) {
    vec3 width = fwidth(vCorner);
    vec3 d = vCorner / width;
    float tiny = smoothstep(0.16, 0.55, max(width.x, max(width.y, width.z))); // no room for lines
    c = mix(c, INK, mix(0.62, 0.12, tiny) * (1.0 - smoothstep(0.3, 1.1, min(d.x, min(d.y, d.z)))));
  }
  color = vec4(mix(c, ground, fade), 1.0);
}
