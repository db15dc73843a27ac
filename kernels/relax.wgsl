// One colour of a Gauss-Seidel pass of stretch-minimising relaxation: every vertex of the colour moves towards the
// mean of its ring, weighted by weight / sigma, as far as no triangle of its ring comes near to turning over.
// Vertices of one colour share no edge, so each sees its ring at rest. Reference: src/kernel/relax.rs.

// How often a step is halved before the vertex stays where it is: down to 1/64 of the full step.
const TRIES: u32 = 7u;
// The least share of the area of a vertex's ring that a step may leave to one triangle; without it, triangles of a
// ring that stretch drives to one side shrink from sweep to sweep until no step is possible.
const MIN_SHARE: f32 = 1e-5;
// Bound of the rounding error of a doubled triangle area, relative to the sum of its two products: Shewchuk's
// (3 + 16 u) u with u = 2^-24 is 1.8e-7. Above it the exact area of the rounded corners is positive.
const AREA_ERROR: f32 = 2.5e-7;
// What products that underflow may lose of a doubled area.
const AREA_UNDERFLOW: f32 = 1e-30;

struct RelaxParams {
    // The vertices of this dispatch: vertices[first .. first + count].
    first: u32,
    count: u32,
    // Length of the first step tried: 1 goes to the mean itself, more than 1 over-relaxes.
    step: f32,
    unused: u32,
}

@group(0) @binding(0) var<uniform> params: RelaxParams;
@group(0) @binding(1) var<storage, read> vertices: array<u32>;
@group(0) @binding(2) var<storage, read> ring_starts: array<u32>;
@group(0) @binding(3) var<storage, read> rings: array<u32>;
@group(0) @binding(4) var<storage, read> weights: array<f32>;
@group(0) @binding(5) var<storage, read> sigma: array<f32>;
@group(0) @binding(6) var<storage, read_write> positions: array<vec4<f32>>;

// Towards the weighted mean of the ring, seen from p.
fn displacement(start: u32, end: u32, p: vec2<f32>) -> vec2<f32> {
    var sum = vec2<f32>(0.0, 0.0);
    var total = 0.0;
    for (var k = start; k < end; k += 1u) {
        let weight = weights[k] / sigma[rings[k]];
        sum += weight * (positions[rings[k]].xy - p);
        total += weight;
    }
    if (!(total > 0.0)) {
        return vec2<f32>(0.0, 0.0);
    }
    return sum / total;
}

// The two products whose difference is twice the area of triangle (p, q, r).
fn area_products(p: vec2<f32>, q: vec2<f32>, r: vec2<f32>) -> vec2<f32> {
    let u = q - p;
    let w = r - p;
    return vec2<f32>(u.x * w.y, u.y * w.x);
}

// Twice the area inside the ring.
fn ring_area(start: u32, end: u32, p: vec2<f32>) -> f32 {
    var sum = 0.0;
    var q = positions[rings[end - 1u]].xy;
    for (var k = start; k < end; k += 1u) {
        let r = positions[rings[k]].xy;
        let products = area_products(p, q, r);
        sum += products.x - products.y;
        q = r;
    }
    return sum;
}

// Whether every triangle of the ring, with its centre at p, has more than `least` as its doubled area.
fn ring_holds(start: u32, end: u32, p: vec2<f32>, least: f32) -> bool {
    var q = positions[rings[end - 1u]].xy;
    for (var k = start; k < end; k += 1u) {
        let r = positions[rings[k]].xy;
        let products = area_products(p, q, r);
        let error = AREA_ERROR * (abs(products.x) + abs(products.y)) + AREA_UNDERFLOW;
        if (!(products.x - products.y > least + error)) {
            return false;
        }
        q = r;
    }
    return true;
}

@compute @workgroup_size(64)
fn relax(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= params.count) {
        return;
    }
    let v = vertices[params.first + id.x];
    let start = ring_starts[v];
    let end = ring_starts[v + 1u];
    if (start == end) {
        return;
    }
    let p = positions[v].xy;
    let move_by = displacement(start, end, p);
    let least = max(MIN_SHARE * ring_area(start, end, p), 0.0);
    var step = params.step;
    for (var i = 0u; i < TRIES; i += 1u) {
        let candidate = p + step * move_by;
        if (ring_holds(start, end, candidate, least)) {
            positions[v] = vec4<f32>(candidate, 0.0, 0.0);
            return;
        }
        step = step * 0.5;
    }
}
