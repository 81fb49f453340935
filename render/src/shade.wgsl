// The GPU painter's shaders: lit triangles with their wire, and flat ink. Twin of globals.rs and cpu.rs.

struct Globals {
    view_projection: mat4x4<f32>,
    lights: array<vec4<f32>, 3>,
    wire: vec4<f32>,
    measures: vec4<f32>,
}

@group(0) @binding(0) var<uniform> globals: Globals;

// WIRE_FLOOR of globals.rs.
const wire_floor: f32 = 0.16;

struct Lit {
    @builtin(position) clip: vec4<f32>,
    @location(0) normal: vec3<f32>,
    @location(1) colour: vec3<f32>,
    @location(2) weights: vec3<f32>,
}

@vertex
fn mesh_vertex(
    @builtin(vertex_index) index: u32,
    @location(0) position: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) colour: vec4<f32>,
) -> Lit {
    let place = index % 3u;
    var lit: Lit;
    lit.clip = globals.view_projection * vec4<f32>(position, 1.0);
    lit.normal = normal;
    lit.colour = colour.rgb;
    lit.weights = vec3<f32>(f32(place == 0u), f32(place == 1u), f32(place == 2u));
    return lit;
}

fn light(normal: vec3<f32>) -> f32 {
    var sum = globals.measures.w;
    for (var i = 0u; i < 3u; i++) {
        sum += globals.lights[i].w * max(dot(normal, globals.lights[i].xyz), 0.0);
    }
    return sqrt(sum);
}

fn wire_cover(weights: vec3<f32>, slopes_raw: vec3<f32>) -> f32 {
    let slopes = max(slopes_raw, vec3<f32>(1e-6));
    let distances = weights / slopes;
    let distance = min(distances.x, min(distances.y, distances.z));
    let height = 1.0 / max(slopes.x, max(slopes.y, slopes.z));
    let faint = globals.measures.y;
    let size = clamp((height - faint) / (globals.measures.z - faint), 0.0, 1.0);
    return clamp(globals.measures.x + 0.5 - distance, 0.0, 1.0) * (wire_floor + (1.0 - wire_floor) * size);
}

fn wire_lift(shaded: vec3<f32>) -> f32 {
    return 0.42 * (1.0 - min(4.0 * dot(shaded, vec3<f32>(0.3, 0.6, 0.1)), 1.0));
}

@fragment
fn mesh_fragment(lit: Lit, @builtin(front_facing) front: bool) -> @location(0) vec4<f32> {
    // Slopes first: derivatives must not stand behind a branch.
    let along = dpdx(lit.weights);
    let down = dpdy(lit.weights);
    let slopes = sqrt(along * along + down * down);
    let size = length(lit.normal);
    let unit = select(vec3<f32>(0.0), lit.normal / size, size > 0.0);
    let normal = select(-unit, unit, front);
    let shaded = min(lit.colour * light(normal), vec3<f32>(1.0));
    let cover = globals.wire.w * wire_cover(lit.weights, slopes);
    return vec4<f32>(mix(shaded, globals.wire.rgb + wire_lift(shaded), cover), 1.0);
}

struct Ink {
    @builtin(position) clip: vec4<f32>,
    @location(0) colour: vec4<f32>,
}

@vertex
fn ink_vertex(@location(0) position: vec3<f32>, @location(1) colour: vec4<f32>) -> Ink {
    return Ink(vec4<f32>(position, 1.0), colour);
}

@fragment
fn ink_fragment(ink: Ink) -> @location(0) vec4<f32> {
    return ink.colour;
}
