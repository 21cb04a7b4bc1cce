// What the graphics card computes: for every point, and for every pixel.

const SHADOW = 1024; // pixels of a side of the map of shadows

const VERTEX = `#version 300 es
  layout(location = 0) in vec4 at; // on the shape of size 1; w: which end of a capsule it belongs to
  layout(location = 1) in vec3 outward;
  uniform mat4 view, sun, pose;
  uniform vec3 size, shift;
  uniform float stretch;
  out vec3 place, normal, own, lit;
  void main() {
    own = at.xyz * size + vec3(0, 0, stretch * at.w) + shift;
    vec4 world = pose * vec4(own, 1);
    place = world.xyz;
    normal = mat3(pose) * (outward / size);
    lit = (sun * world).xyz * 0.5 + 0.5;
    lit.z -= 0.002; // so that nothing shades itself
    gl_Position = view * world;
  }`;
const DARK = `#version 300 es
  precision mediump float;
  void main() {}`;
const PAINT = `#version 300 es
  precision highp float;
  precision highp sampler2DShadow;
  in vec3 place, normal, own, lit;
  uniform vec4 colour;
  uniform vec3 eye, target, towards;
  uniform float squares, reach; // edge of the squares of ground, and where ground ends
  uniform sampler2DShadow shadow;
  out vec4 paint;
  const vec3 SOFT = vec3(0.6, 0.6, 0) / ${SHADOW}.0;
  void main() {
    vec3 n = normalize(normal), v = normalize(eye - place), base = colour.rgb;
    if (dot(n, v) < 0.0 && !gl_FrontFacing) n = -n;
    float alpha = colour.a;
    if (squares > 0.0) {
      alpha *= 1.0 - smoothstep(0.25 * reach, reach, distance(place, target));
      vec2 q = own.xy / squares, w = fwidth(q) + 1e-4;
      vec2 i = 2.0 * (abs(fract((q - 0.5 * w) * 0.5) - 0.5) - abs(fract((q + 0.5 * w) * 0.5) - 0.5)) / w;
      base *= 1.0 - 0.14 * (0.5 - 0.5 * i.x * i.y);
    }
    float facing = dot(n, towards);
    vec3 c = base * mix(vec3(0.30, 0.27, 0.25), vec3(0.50, 0.54, 0.60), 0.5 + 0.5 * n.z);
    if (facing > 0.0) {
      float light = 1.0;
      if (all(greaterThan(lit, vec3(0))) && all(lessThan(lit, vec3(1)))) {
        light = 0.5 * (texture(shadow, lit - SOFT) + texture(shadow, lit + SOFT));
      }
      c += base * vec3(0.72, 0.69, 0.64) * light * facing;
      if (squares == 0.0) c += 0.25 * light * pow(max(dot(n, normalize(towards + v)), 0.0), 40.0);
    }
    paint = vec4(sqrt(min(c, 1.0)) * alpha, alpha);
  }`;
