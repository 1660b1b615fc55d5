// Programs of the graphics card.
const PART_VERTEX = `#version 300 es
precision highp float;
layout(location=0) in vec3 place;
layout(location=1) in vec2 octahedral;
layout(location=2) in float code;
layout(location=3) in float surface;
uniform mat4 camera; uniform vec3 low, size; uniform vec2 turn; uniform vec2 law;
// At the edge of a triangle a value is that of a place inside of it, not one beyond the edge.
centroid out vec3 normal, position; centroid out float deviation, state, kind;
vec3 turned(vec3 p) { return vec3(p.x * turn.x - p.y * turn.y, p.x * turn.y + p.y * turn.x, p.z); }
void main() {
  position = turned(low + place * size);
  vec3 n = vec3(octahedral, 1.0 - abs(octahedral.x) - abs(octahedral.y));
  float t = max(-n.z, 0.0);
  n.xy -= t * vec2(n.x < 0.0 ? -1.0 : 1.0, n.y < 0.0 ? -1.0 : 1.0);
  normal = turned(normalize(n));
  state = code > 32766.5 ? 1.0 : code < -32767.5 ? -1.0 : 0.0;
  deviation = state == 0.0 ? law.x * sinh(code / law.y) : 0.0;
  kind = surface;
  gl_Position = camera * vec4(position, 1.0);
}`;

/** Leaves out what lies beyond the section plane, and shows the inner side of what it opens as cut material. A program without a
 * section is another one: where a fragment may be left out, hidden ones cannot be told before they are shaded. */
const SECTION = `
uniform float grain;
#ifdef OPENED
uniform vec4 plane;
void section(vec3 p) { if (dot(plane.xyz, p) > plane.w) discard; }
vec3 cutMaterial() {
  float stripe = step(0.5, fract(grain * (gl_FragCoord.x - gl_FragCoord.y) / 10.0));
  return mix(vec3(0.46, 0.52, 0.44), vec3(0.56, 0.62, 0.53), stripe);
}
#else
void section(vec3 p) { }
#endif`;

const LIGHT = `
vec3 lit(vec3 base, vec3 n, vec3 position) {
  vec3 toEye = normalize(eye - position);
  if (dot(n, toEye) < 0.0) n = -n;
  vec3 key = normalize(toEye + 0.55 * upward - 0.35 * rightward);
  float shine = pow(max(dot(n, normalize(key + toEye)), 0.0), 40.0);
  return base * (0.40 + 0.50 * max(dot(n, key), 0.0) + 0.16 * max(dot(n, toEye), 0.0)) + 0.10 * shine;
}`;

const PART_COLOUR = `#version 300 es
precision highp float;
centroid in vec3 normal, position; centroid in float deviation, state, kind;
uniform vec3 eye, upward, rightward; uniform vec2 scale, shaded; uniform vec3 outside[6], shades[2], special[3];
uniform float bands, beyond;
out vec4 colour;
${SECTION}
${LIGHT}
/** Colour of a deviation in units of the tolerance: neutral or a pale shade up to 1, then a ramp that begins at 1. */
vec3 ramp(float t) {
  int side = t < 0.0 ? 0 : 1;
  float a = abs(t);
  if (a <= 1.0) {
    if (bands > 0.5) a = floor(a * 4.0) / 4.0;
    return mix(special[0], shades[side], a * (side == 0 ? shaded.x : shaded.y));
  }
  float x = 2.0 * clamp((a - 1.0) / (beyond - 1.0), 0.0, 1.0);
  if (bands > 0.5) x = min(floor(x * 2.0) / 2.0, 2.0);
  int i = 3 * side + (x < 1.0 ? 0 : 1);
  return mix(outside[i], outside[i + 1], x < 1.0 ? x : x - 1.0);
}
void main() {
  section(position);
  vec3 n = normalize(normal);
#ifdef OPENED
  if (dot(n, eye - position) < 0.0) { colour = vec4(cutMaterial(), 1.0); return; }
#endif
  vec3 base;
  if (state > 0.02) {
    float stripe = step(0.5, fract(grain * (gl_FragCoord.x + gl_FragCoord.y) / 9.0));
    base = special[1] * (0.7 + 0.6 * stripe);
  } else if (state < -0.5) {
    base = special[2];
  } else {
    base = ramp(deviation < 0.0 ? deviation / scale.x : deviation / scale.y);
  }
  colour = vec4(lit(base, n, position), 1.0);
}`;

const PLAIN_VERTEX = `#version 300 es
precision highp float;
layout(location=0) in vec3 place;
uniform mat4 camera, model; uniform vec3 low, size;
out vec3 position;
void main() {
  vec4 p = model * vec4(low + place * size, 1.0);
  position = p.xyz;
  gl_Position = camera * p;
}`;

const PLAIN_COLOUR = `#version 300 es
precision highp float;
in vec3 position;
uniform vec3 eye, upward, rightward; uniform vec4 tint;
out vec4 colour;
${SECTION}
${LIGHT}
void main() {
  section(position);
#ifdef OPENED
  if (!gl_FrontFacing) { colour = vec4(cutMaterial(), 1.0); return; }
#endif
  vec3 n = normalize(cross(dFdx(position), dFdy(position)));
  colour = vec4(lit(tint.rgb, n, position) * tint.a, tint.a);
}`;

const LINE_VERTEX = `#version 300 es
precision highp float;
layout(location=0) in vec3 place;
layout(location=1) in float way;
uniform mat4 camera; uniform float lift;
out float along; out vec3 position;
void main() {
  along = way;
  position = place;
  gl_Position = camera * vec4(place, 1.0);
  gl_Position.z -= lift * gl_Position.w;
}`;

const LINE_COLOUR = `#version 300 es
precision highp float;
in float along; in vec3 position;
uniform vec4 tint; uniform float dash;
out vec4 colour;
${SECTION}
void main() {
  section(position);
  if (dash > 0.0 && fract(along / dash) > 0.55) discard;
  colour = vec4(tint.rgb * tint.a, tint.a);
}`;

const MARK_VERTEX = `#version 300 es
precision highp float;
uniform mat4 camera; uniform vec3 place; uniform float points;
void main() { gl_Position = camera * vec4(place, 1.0); gl_PointSize = points; }`;

const MARK_COLOUR = `#version 300 es
precision highp float;
uniform vec4 tint;
out vec4 colour;
void main() {
  float r = length(gl_PointCoord - 0.5) * 2.0;
  float ring = smoothstep(0.58, 0.66, r) * (1.0 - smoothstep(0.88, 0.96, r));
  float halo = smoothstep(0.48, 0.56, r) * (1.0 - smoothstep(0.92, 1.0, r));
  float centre = 1.0 - smoothstep(0.10, 0.16, r);
  float a = max(max(ring, halo * 0.9), centre);
  colour = vec4(mix(vec3(1.0), tint.rgb, max(ring, centre)) * a, a);
}`;
