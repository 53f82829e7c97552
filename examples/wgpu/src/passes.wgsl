// wgpu's side: a waving cloth, a camera, and what a picture is made of hits.

struct Ray { origin: vec3f, t_min: f32, direction: vec3f, t_max: f32 }
struct Hit { t: f32, u: f32, v: f32, triangle: u32 }

// As `gridwalk::Geometry`, `Ray` and `Hit` lie in memory: an array of vec3f would have gaps.
@group(0) @binding(0) var<storage, read_write> positions: array<f32>;
@group(0) @binding(1) var<storage, read_write> indices: array<u32>;
@group(0) @binding(2) var<storage, read_write> rays: array<Ray>;
@group(0) @binding(3) var<storage, read_write> hits: array<Hit>;
@group(0) @binding(4) var<storage, read_write> picture: array<u32>;

override side: u32; // quads along a side of the cloth
override width: u32;
override height: u32;

@compute @workgroup_size(8, 8)
fn vertices(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy > vec2u(side))) { return; }
    let place = 8.0 * vec2f(id.xy) / f32(side) - 4.0;
    let wave = 0.35 * sin(1.7 * place.x + 0.6 * place.y) * cos(1.3 * place.y) + 0.12 * sin(5.0 * length(place - vec2f(0.7, -0.4)));
    let vertex = id.y * (side + 1u) + id.x;
    positions[3u * vertex] = place.x;
    positions[3u * vertex + 1u] = wave;
    positions[3u * vertex + 2u] = place.y;
    if (all(id.xy < vec2u(side))) {
        let first = 6u * (id.y * side + id.x);
        indices[first] = vertex;
        indices[first + 1u] = vertex + side + 1u;
        indices[first + 2u] = vertex + 1u;
        indices[first + 3u] = vertex + 1u;
        indices[first + 4u] = vertex + side + 1u;
        indices[first + 5u] = vertex + side + 2u;
    }
}

@compute @workgroup_size(8, 8)
fn camera(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= width || id.y >= height) { return; }
    let screen = (2.0 * vec2f(id.xy) + 1.0 - vec2f(f32(width), f32(height))) / f32(height);
    let direction = vec3f(screen.x, -screen.y - 0.9, -2.0);
    rays[id.y * width + id.x] = Ray(vec3f(0.0, 2.6, 5.2), 0.0, direction, 1e30);
}

fn position(triangle: u32, corner: u32) -> vec3f {
    let vertex = 3u * indices[3u * triangle + corner];
    return vec3f(positions[vertex], positions[vertex + 1u], positions[vertex + 2u]);
}

@compute @workgroup_size(8, 8)
fn shade(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= width || id.y >= height) { return; }
    let pixel = id.y * width + id.x;
    let hit = hits[pixel];
    var colour = mix(vec3f(0.9, 0.9, 0.88), vec3f(0.45, 0.6, 0.85), 1.0 - f32(id.y) / f32(height));
    if (hit.triangle < 0xFFFFFFFEu) { // neither GRIDWALK_MISS nor GRIDWALK_UNFINISHED
        let a = position(hit.triangle, 0u);
        let b = position(hit.triangle, 1u);
        let c = position(hit.triangle, 2u);
        let normal = normalize(cross(b - a, c - a));
        let place = (1.0 - hit.u - hit.v) * a + hit.u * b + hit.v * c;
        let light = 0.25 + 0.75 * max(dot(normal, normalize(vec3f(0.5, 1.0, 0.3))), 0.0);
        let even = (i32(floor(place.x)) + i32(floor(place.z))) % 2 == 0;
        colour = light * select(vec3f(0.75, 0.2, 0.15), vec3f(0.92, 0.88, 0.8), even);
    }
    let bytes = vec3u(255.0 * pow(colour, vec3f(1.0 / 2.2)) + 0.5);
    picture[pixel] = bytes.r | (bytes.g << 8u) | (bytes.b << 16u) | 0xFF000000u;
}
