// The shaders: one for everything that is seen, with modes, and one for the depth that shadows are taken from.

export const MODE = { lit: 0, plain: 1, rim: 2, shadow: 3, grid: 4 };

export const VERTEX = `#version 300 es
in vec3 p, n, c;
uniform mat4 model, view, sunView;
out vec3 place, normal, colour;
out vec4 inSun;
void main() {
  vec4 world = model * vec4(p, 1.0);
  place = world.xyz;
  normal = mat3(model) * n;
  colour = c;
  inSun = sunView * vec4(world.xyz + normalize(normal + 1e-6) * 6.0, 1.0);
  gl_Position = view * world;
}`;

export const FRAGMENT = `#version 300 es
precision highp float;
precision highp sampler2DShadow;
in vec3 place, normal, colour;
in vec4 inSun;
uniform vec3 eye, tint, sun;
uniform vec4 fade; // middle of the floor, and where the grid begins and ends to fade
uniform float alpha, dark;
uniform int mode, soft; // soft: how many depths about a place its shadow is taken from, to each side
uniform sampler2DShadow depths;
out vec4 seen;

float lit() {
  vec3 at = inSun.xyz / inSun.w * 0.5 + 0.5;
  if (any(lessThan(at, vec3(0.0))) || any(greaterThan(at, vec3(1.0)))) return 1.0;
  float sum = 0.0;
  for (int x = -soft; x <= soft; x++)
    for (int y = -soft; y <= soft; y++)
      sum += texture(depths, vec3(at.xy + vec2(x, y) * 0.0009, at.z - 0.0012));
  return sum / float((2 * soft + 1) * (2 * soft + 1));
}

void main() {
  vec3 facing = normalize(normal);
  vec3 toEye = normalize(eye - place);
  float near = 1.0 - smoothstep(fade.z, fade.w, length(place.xy - fade.xy));
  if (mode == ${MODE.plain}) {
    seen = vec4(colour * tint, alpha);
  } else if (mode == ${MODE.rim}) {
    seen = vec4(tint, alpha * pow(1.0 - abs(dot(facing, toEye)), 4.0));
  } else if (mode == ${MODE.shadow}) {
    seen = vec4(0.0, 0.0, 0.0, (1.0 - lit()) * alpha * near);
  } else if (mode == ${MODE.grid}) {
    seen = vec4(tint, alpha * near);
  } else {
    if (dot(facing, toEye) < 0.0) facing = -facing;
    vec3 linear = pow(colour, vec3(2.2));
    float sunlit = lit();
    float direct = sunlit * max(dot(facing, sun), 0.0);
    float shine = pow(max(dot(facing, normalize(sun + toEye)), 0.0), 48.0) * 0.38 * sunlit;
    float rim = pow(1.0 - max(dot(facing, toEye), 0.0), 4.0) * 0.22;
    vec3 sky = mix(vec3(0.30, 0.32, 0.36), vec3(0.72, 0.76, 0.84), facing.z * 0.5 + 0.5) * mix(0.62, 0.46, dark);
    vec3 fill = max(dot(facing, normalize(vec3(-0.7, -0.5, 0.15))), 0.0) * vec3(0.20, 0.23, 0.28);
    vec3 light = linear * (sky + fill + direct * vec3(1.12, 1.08, 1.02)) + shine + rim * sky;
    light = light * (2.51 * light + 0.03) / (light * (2.43 * light + 0.59) + 0.14);
    seen = vec4(pow(light * 0.98, vec3(1.0 / 2.2)), alpha);
  }
}`;

export const DEPTH_FRAGMENT = `#version 300 es
precision highp float;
void main() {}`;
