// One lamp, a sky, a highlight; gamma 2, which a processor without a GPU can afford. Materials (see mesh.rs) come as a number in the colour's last byte.
uniform vec3 u_eye;
// Tip and top of each instrument's shaft, m; the second pair counts when there are two.
uniform vec3 u_shaft_ends[4];
uniform int u_shafts;
in vec3 v_position;
in vec3 v_normal;
in vec4 v_colour;
out vec4 f_colour;

const vec3 LAMP = vec3(-0.42, 0.30, 0.857);

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

void main() {
    int material = int(v_colour.a * 255.0 + 0.5);
    if (material == 3) {
        // Information: nearly its own colour, shaded just enough to be seen as round.
        float round = 0.86 + 0.14 * clamp(dot(normalize(v_normal), normalize(u_eye - v_position)), 0.0, 1.0);
        f_colour = vec4(v_colour.rgb * round, 1.0);
        return;
    }
    vec3 normal = normalize(v_normal);
    vec3 to_eye = normalize(u_eye - v_position);
    vec3 base = v_colour.rgb * v_colour.rgb;
    vec3 halfway = normalize(LAMP + to_eye);
    float facing = dot(normal, LAMP);
    float sky = 0.5 + 0.5 * normal.z;
    float rim = pow(1.0 - clamp(dot(normal, to_eye), 0.0, 1.0), 3.0);
    vec3 shaded;
    if (material == 1) {
        vec2 p = v_position.xy;
        vec2 cell = abs(fract(p * 200.0 - 0.5) - 0.5);
        vec2 width = fwidth(p * 200.0);
        vec2 thread = 1.0 - smoothstep(0.3 * width, 1.1 * width, cell);
        base *= 1.0 - 0.17 * max(thread.x, thread.y);
        float lamp = light_past_shaft(v_position, u_shaft_ends[0], u_shaft_ends[1]);
        if (u_shafts > 1) {
            lamp = min(lamp, light_past_shaft(v_position, u_shaft_ends[2], u_shaft_ends[3]));
        }
        float wrap = clamp((facing + 0.35) / 1.35, 0.0, 1.0) * lamp;
        // Light that entered the tissue comes back redder.
        vec3 diffuse = vec3(0.78, 0.74, 0.72) * wrap + vec3(0.16, 0.06, 0.05) * (1.0 - wrap) * sky;
        float wet = pow(clamp(dot(normal, halfway), 0.0, 1.0), 55.0) * lamp;
        shaded = base * (diffuse + 0.20 * sky) + vec3(0.22) * wet;
    } else if (material == 2) {
        float shine = pow(clamp(dot(normal, halfway), 0.0, 1.0), 40.0);
        float band = smoothstep(0.1, 0.9, sky);
        shaded = base * (0.18 + 0.55 * clamp(facing, 0.0, 1.0) + 0.35 * band) + vec3(0.75) * shine + vec3(0.10, 0.12, 0.14) * rim;
    } else {
        float shine = pow(clamp(dot(normal, halfway), 0.0, 1.0), 24.0);
        shaded = base * (0.70 * clamp(facing, 0.0, 1.0) + 0.28 * sky + 0.06) + vec3(0.08) * shine + vec3(0.03, 0.035, 0.04) * rim;
    }
    f_colour = vec4(sqrt(clamp(shaded, 0.0, 1.0)), 1.0);
}
