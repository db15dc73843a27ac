#version 300 es
// A surface on its way from its first to its second space.
in vec3 position0;
in vec3 position1;
in vec3 normal0;
in vec3 normal1;
in vec2 uv;
in vec4 corner; // weights of the whole triangle's corners; 1 where the triangle is turned over
in vec4 paint;  // the patch's colour
in vec4 values; // three measures in steps of their range; the patch
uniform mat4 view;
uniform mat4 projection;
uniform float slide;
out vec3 vNormal;
out vec3 vPlace;
out vec2 vUv;
out vec3 vCorner;
out vec3 vPaint;
flat out vec3 vValues;
flat out float vPatch;
flat out float vTurned;

void main() {
  vec4 at = view * vec4(mix(position0, position1, slide), 1.0);
  vNormal = mat3(view) * mix(normal0, normal1, slide);
  vPlace = position0;
  vUv = uv;
  vCorner = corner.xyz;
  vTurned = corner.w;
  vPaint = paint.rgb;
  vValues = values.xyz;
  vPatch = floor(values.w * 65535.0 + 0.5);
  gl_Position = projection * at;
}
