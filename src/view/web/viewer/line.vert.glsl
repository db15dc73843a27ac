#version 300 es
// A piece of a line as a strip of constant width in pixels, a little before the surface that it lies on.
in vec3 start0;
in vec3 end0;
in vec3 start1;
in vec3 end1;
uniform mat4 view;
uniform mat4 projection;
uniform float slide;
uniform vec2 size;   // of the panel, pixels
uniform float width; // pixels
uniform float lift;

void main() {
  vec4 a = view * vec4(mix(start0, start1, slide), 1.0);
  vec4 b = view * vec4(mix(end0, end1, slide), 1.0);
  vec4 p = projection * a;
  vec4 q = projection * b;
  vec2 way = (q.xy / q.w - p.xy / p.w) * size;
  way = dot(way, way) > 0.0 ? normalize(way) : vec2(1.0, 0.0);
  bool atEnd = (gl_VertexID & 1) == 1;
  float side = (gl_VertexID & 2) == 2 ? 1.0 : -1.0;
  vec4 at = atEnd ? q : p;
  vec4 lifted = projection * ((atEnd ? b : a) + vec4(0.0, 0.0, lift, 0.0));
  vec2 off = (vec2(-way.y, way.x) * side + way * (atEnd ? 0.5 : -0.5)) * width / size;
  gl_Position = vec4(at.xy + off * at.w, lifted.z / lifted.w * at.w, at.w);
}
