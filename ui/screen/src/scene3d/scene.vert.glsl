// Passes world position and normal on; the light is worked out per fragment.
uniform mat4 u_clip_from_workspace;
in vec3 a_position;
in vec3 a_normal;
in vec4 a_colour;
out vec3 v_position;
out vec3 v_normal;
out vec4 v_colour;

void main() {
    v_position = a_position;
    v_normal = a_normal;
    v_colour = a_colour;
    gl_Position = u_clip_from_workspace * vec4(a_position, 1.0);
}
