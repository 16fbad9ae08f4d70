// One lamp, a sky, a highlight; gamma 2, which a processor without a GPU can afford. One program for each MATERIAL (see mesh.rs) and, where they
// throw shadows, for each number of SHAFTS: a processor works out both sides of every branch.
uniform vec3 u_eye;
#if MATERIAL != 3
// What a surface loses of its brightness per metre, and from which distance on: the depth cue.
uniform vec2 u_dims;
#endif
#if MATERIAL == 1
// Tip and top of each instrument's shaft, m.
uniform vec3 u_shaft_ends[2 * SHAFTS];
#endif
in vec3 v_position;
in vec3 v_normal;
in vec4 v_colour;
out vec4 f_colour;

const vec3 LAMP = vec3(-0.42, 0.30, 0.857);

#if MATERIAL == 1
// How much lamp light reaches p past the instrument's shaft: distance between the ray to the lamp and the shaft's axis.
float light_past_shaft(vec3 p, vec3 tip, vec3 top) {
    vec3 v = top - tip;
    vec3 w = p - tip;
    float b = dot(LAMP, v);
    float c = dot(v, v);
    float d = dot(LAMP, w);
    float t = clamp((dot(v, w) - d * b) / max(c - b * b, 1e-9), 0.0, 1.0);
    float s = max(t * b - d, 0.0);
    float gap = length(w + s * LAMP - t * v);
    float blur = 0.0012 + 0.10 * s;
    return mix(0.35, 1.0, smoothstep(0.0026 - 0.5 * blur, 0.0026 + blur, gap));
}
#endif

void main() {
    vec3 normal = normalize(v_normal);
    vec3 ray = u_eye - v_position;
    float range = length(ray);
    vec3 to_eye = ray / range;
#if MATERIAL == 3
    // Information: nearly its own colour, shaded just enough to be seen as round.
    f_colour = vec4(v_colour.rgb * (0.86 + 0.14 * clamp(dot(normal, to_eye), 0.0, 1.0)), 1.0);
#else
    vec3 base = v_colour.rgb * v_colour.rgb;
    vec3 halfway = normalize(LAMP + to_eye);
    float facing = dot(normal, LAMP);
    float sky = 0.5 + 0.5 * normal.z;
    // Powers by multiplying: far cheaper than by logarithms.
    float s = clamp(dot(normal, halfway), 0.0, 1.0);
    float s2 = s * s;
    float s4 = s2 * s2;
    float s8 = s4 * s4;
    float s16 = s8 * s8;
    vec3 shaded;
#if MATERIAL == 1
    vec2 p = v_position.xy;
    vec2 cell = abs(fract(p * 200.0 - 0.5) - 0.5);
    vec2 width = fwidth(p * 200.0);
    vec2 thread = 1.0 - smoothstep(0.3 * width, 1.1 * width, cell);
    base *= 1.0 - 0.17 * max(thread.x, thread.y);
    float lamp = light_past_shaft(v_position, u_shaft_ends[0], u_shaft_ends[1]);
#if SHAFTS > 1
    lamp = min(lamp, light_past_shaft(v_position, u_shaft_ends[2], u_shaft_ends[3]));
#endif
    float wrap = clamp((facing + 0.35) / 1.35, 0.0, 1.0) * lamp;
    // Light that entered the tissue comes back redder.
    vec3 diffuse = vec3(0.78, 0.74, 0.72) * wrap + vec3(0.16, 0.06, 0.05) * (1.0 - wrap) * sky;
    float wet = s16 * s16 * s16 * s4 * s2 * s * lamp;
    shaded = base * (diffuse + 0.20 * sky) + vec3(0.22) * wet;
#else
    float away = 1.0 - clamp(dot(normal, to_eye), 0.0, 1.0);
    float rim = away * away * away;
#if MATERIAL == 2
    float shine = s16 * s16 * s8;
    float band = smoothstep(0.1, 0.9, sky);
    shaded = base * (0.18 + 0.55 * clamp(facing, 0.0, 1.0) + 0.35 * band) + vec3(0.75) * shine + vec3(0.10, 0.12, 0.14) * rim;
#else
    float shine = s16 * s8;
    shaded = base * (0.70 * clamp(facing, 0.0, 1.0) + 0.28 * sky + 0.06) + vec3(0.08) * shine + vec3(0.03, 0.035, 0.04) * rim;
#endif
#endif
    shaded *= clamp(1.0 - u_dims.x * (range - u_dims.y), 0.25, 1.1);
    f_colour = vec4(sqrt(clamp(shaded, 0.0, 1.0)), 1.0);
#endif
}
