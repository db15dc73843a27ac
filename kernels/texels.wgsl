// The triangle that owns every texel of a window, and the texel's barycentric weights in it.
// Reference: src/kernel/texels.rs.

// Stands for the triangle of a texel that none covers.
const NO_TRIANGLE: u32 = 0xffffffffu;
// Cells, for which candidate triangles are listed, have this many texels along a side.
const CELL: u32 = 8u;

@group(0) @binding(0) var<uniform> params: TexelParams;
@group(0) @binding(1) var<storage, read> triangles: array<FlatTriangle>;
@group(0) @binding(2) var<storage, read> starts: array<u32>;
@group(0) @binding(3) var<storage, read> candidates: array<u32>;
@group(0) @binding(4) var<storage, read_write> all_texels: array<Texel>;

struct TexelParams {
    first: u32,
    count: u32,
    width: u32,
    unused: u32,
}

// Corners in texels from the window's upper left corner, y downwards; the area is positive.
struct FlatTriangle {
    ax: f32,
    ay: f32,
    bx: f32,
    by: f32,
    cx: f32,
    cy: f32,
}

struct Texel {
    triangle: u32,
    covers: u32,
    w1: f32,
    w2: f32,
}

fn precedes(p: vec2<f32>, q: vec2<f32>) -> bool {
    return p.x < q.x || (p.x == q.x && p.y < q.y);
}

fn double_area(p: vec2<f32>, q: vec2<f32>, x: vec2<f32>) -> f32 {
    return (q.x - p.x) * (x.y - p.y) - (q.y - p.y) * (x.x - p.x);
}

// Twice the area at the left of an edge, bit for bit the negative of that of the edge the other way.
fn beside(p: vec2<f32>, q: vec2<f32>, x: vec2<f32>) -> f32 {
    if (precedes(p, q)) {
        return double_area(p, q, x);
    }
    return -double_area(q, p, x);
}

fn holds(area: f32, p: vec2<f32>, q: vec2<f32>) -> bool {
    return area > 0.0 || (area == 0.0 && precedes(p, q));
}

@compute @workgroup_size(64)
fn texels(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= params.count) {
        return;
    }
    let i = params.first + id.x;
    let column = i % params.width;
    let row = i / params.width;
    let x = vec2<f32>(f32(column) + 0.5, f32(row) + 0.5);
    let cell = (row / CELL) * ((params.width + CELL - 1u) / CELL) + column / CELL;
    var texel = Texel(NO_TRIANGLE, 0u, 0.0, 0.0);
    for (var k = starts[cell]; k < starts[cell + 1u]; k += 1u) {
        let t = triangles[candidates[k]];
        let a = vec2<f32>(t.ax, t.ay);
        let b = vec2<f32>(t.bx, t.by);
        let c = vec2<f32>(t.cx, t.cy);
        let at_a = beside(b, c, x);
        let at_b = beside(c, a, x);
        let at_c = beside(a, b, x);
        if (holds(at_a, b, c) && holds(at_b, c, a) && holds(at_c, a, b)) {
            let sum = at_a + at_b + at_c;
            if (sum > 0.0) {
                if (texel.covers == 0u) {
                    let per_sum = 1.0 / sum;
                    texel.triangle = candidates[k];
                    texel.w1 = at_b * per_sum;
                    texel.w2 = at_c * per_sum;
                }
                texel.covers += 1u;
            }
        }
    }
    all_texels[i] = texel;
}
