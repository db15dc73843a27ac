// One colour of a sweep over domains in which one mesh moves over another: every vertex of the colour makes a Newton step
// of its own that lowers the symmetric Dirichlet energy of its triangles, as far as none of them turns over. Vertices of
// one colour share no triangle, so each sees its ring at rest. Reference: src/kernel/sweep_lanes.rs.

// A step goes at most this share of the way to the first triangle that collapses.
const SAFE_SHARE: f32 = 0.8;
// How often a step is tried, each time half as long, before the vertex stays where it is.
const TRIES: u32 = 4u;
// Energy of a triangle that has turned over: more than any other, and few of them add up without overflow.
const FOLDED: f32 = 1e36;

struct SweepParams {
    // The vertices of this dispatch: vertices[first .. first + count].
    first: u32,
    count: u32,
}

// A moving triangle and the metrics it sees below it; symmetric matrices are (xx, xy, yy, unused).
struct Sight {
    // Maps the unit vectors to the triangle's edges at its first corner, at rest, inverted; column by column.
    rest: vec4<f32>,
    // Weighted sum of the metrics.
    sum: vec4<f32>,
    // The same of the metrics divided by their determinants.
    inverse: vec4<f32>,
}

@group(0) @binding(0) var<uniform> params: SweepParams;
@group(0) @binding(1) var<storage, read> vertices: array<u32>;
@group(0) @binding(2) var<storage, read> fan_starts: array<u32>;
// The triangles around every vertex: four times the triangle, plus the corner that the vertex is of it.
@group(0) @binding(3) var<storage, read> fans: array<u32>;
@group(0) @binding(4) var<storage, read> triangles: array<vec4<u32>>;
@group(0) @binding(5) var<storage, read> sights: array<Sight>;
// Where a vertex was at first, and how far it has come since: differences keep their bits where triangles are tiny.
@group(0) @binding(6) var<storage, read_write> positions: array<vec4<f32>>;

// From p to q.
fn between(p: vec4<f32>, q: vec4<f32>) -> vec2<f32> {
    return vec2<f32>((q.x - p.x) + (q.z - p.z), (q.y - p.y) + (q.w - p.w));
}

// The map from a triangle at rest into the plane, its two columns one after the other; u and w are its edges there from
// its first corner.
fn map_of(rest: vec4<f32>, u: vec2<f32>, w: vec2<f32>) -> vec4<f32> {
    return vec4<f32>(
        u.x * rest.x + w.x * rest.y,
        u.y * rest.x + w.y * rest.y,
        u.x * rest.z + w.x * rest.w,
        u.y * rest.z + w.y * rest.w,
    );
}

// A symmetric matrix (xx, xy, yy) times the columns of m.
fn times(s: vec4<f32>, m: vec4<f32>) -> vec4<f32> {
    return vec4<f32>(
        s.x * m.x + s.y * m.y,
        s.y * m.x + s.z * m.y,
        s.x * m.z + s.y * m.w,
        s.y * m.z + s.z * m.w,
    );
}

fn dot4(a: vec4<f32>, b: vec4<f32>) -> f32 {
    return ((a.x * b.x + a.y * b.y) + a.z * b.z) + a.w * b.w;
}

fn energy_of(sight: Sight, u: vec2<f32>, w: vec2<f32>) -> f32 {
    let m = map_of(sight.rest, u, w);
    let det = m.x * m.w - m.y * m.z;
    if (!(det > 0.0)) {
        return FOLDED;
    }
    let p = dot4(m, times(sight.sum, m));
    let q = dot4(m, times(sight.inverse, m));
    return (p + q / (det * det)) * 0.25;
}

// The corners of the triangle at an entry of the fans, the centre of the fan put to `centre`.
fn corners_of(entry: u32, centre: vec4<f32>) -> array<vec4<f32>, 3> {
    let t = triangles[entry / 4u];
    let corner = entry % 4u;
    var corners = array<vec4<f32>, 3>(positions[t.x], positions[t.y], positions[t.z]);
    corners[corner] = centre;
    return corners;
}

fn fan_energy(start: u32, end: u32, centre: vec4<f32>) -> f32 {
    var sum = 0.0;
    for (var k = start; k < end; k += 1u) {
        var c = corners_of(fans[k], centre);
        sum += energy_of(sights[fans[k] / 4u], between(c[0], c[1]), between(c[0], c[2]));
    }
    return sum;
}

struct Slope {
    gradient: vec2<f32>,
    // xx, xy, yy of the second derivative.
    hessian: vec3<f32>,
}

// Derivatives of a triangle's energy by the corner whose weights of the columns are `by`.
fn slope_of(sight: Sight, u: vec2<f32>, w: vec2<f32>, by: vec2<f32>) -> Slope {
    let m = map_of(sight.rest, u, w);
    let det = m.x * m.w - m.y * m.z;
    let d2 = det * det;
    let pm = times(sight.sum, m);
    let qm = times(sight.inverse, m);
    let q = dot4(m, qm);
    // What P m, Q m and the cofactor of m make of the weights.
    let p = vec2<f32>(pm.x * by.x + pm.z * by.y, pm.y * by.x + pm.w * by.y);
    let a = vec2<f32>(qm.x * by.x + qm.z * by.y, qm.y * by.x + qm.w * by.y);
    let g = vec2<f32>(m.w * by.x - m.y * by.y, m.x * by.y - m.z * by.x);
    let along = 0.5 / d2;
    let across = 0.5 * (q / (d2 * det));
    let square = by.x * by.x + by.y * by.y;
    let cross = 1.0 / (d2 * det);
    let push = 2.0 * (q / (d2 * d2));
    let gradient = vec2<f32>(
        (0.5 * p.x + along * a.x) - across * g.x,
        (0.5 * p.y + along * a.y) - across * g.y,
    );
    let hessian = vec3<f32>(
        ((0.5 * sight.sum.x + along * sight.inverse.x) * square - cross * (2.0 * a.x * g.x)) + push * (g.x * g.x),
        ((0.5 * sight.sum.y + along * sight.inverse.y) * square - cross * (a.x * g.y + g.x * a.y)) + push * (g.x * g.y),
        ((0.5 * sight.sum.z + along * sight.inverse.z) * square - cross * (2.0 * a.y * g.y)) + push * (g.y * g.y),
    );
    return Slope(gradient, hessian);
}

// How much each corner has of the columns of the map.
fn weights_of(rest: vec4<f32>, corner: u32) -> vec2<f32> {
    if (corner == 1u) {
        return vec2<f32>(rest.x, rest.z);
    }
    if (corner == 2u) {
        return vec2<f32>(rest.y, rest.w);
    }
    return vec2<f32>(-(rest.x + rest.y), -(rest.z + rest.w));
}

// The Newton step of the energy of a fan; zero where there is none.
fn newton(start: u32, end: u32, centre: vec4<f32>) -> vec2<f32> {
    var gradient = vec2<f32>(0.0, 0.0);
    var hessian = vec3<f32>(0.0, 0.0, 0.0);
    for (var k = start; k < end; k += 1u) {
        var c = corners_of(fans[k], centre);
        let sight = sights[fans[k] / 4u];
        let by = weights_of(sight.rest, fans[k] % 4u);
        let slope = slope_of(sight, between(c[0], c[1]), between(c[0], c[2]), by);
        gradient += slope.gradient;
        hessian += slope.hessian;
    }
    let det = hessian.x * hessian.z - hessian.y * hessian.y;
    if (!(det > 0.0)) {
        return vec2<f32>(0.0, 0.0);
    }
    return vec2<f32>(
        (hessian.y * gradient.y - hessian.z * gradient.x) / det,
        (hessian.y * gradient.x - hessian.x * gradient.y) / det,
    );
}

// The share of the step that is safe: less than the way to the first triangle that collapses, and no more than all.
fn safe_share(start: u32, end: u32, centre: vec4<f32>, step: vec2<f32>) -> f32 {
    var share = 1.0;
    for (var k = start; k < end; k += 1u) {
        var c = corners_of(fans[k], centre);
        let corner = fans[k] % 4u;
        let next = c[(corner + 1u) % 3u];
        let last = c[(corner + 2u) % 3u];
        let u = between(centre, next);
        let w = between(centre, last);
        let side = between(next, last);
        let area = u.x * w.y - u.y * w.x;
        let loss = step.x * side.y - step.y * side.x;
        if (loss > 0.0) {
            share = min(share, SAFE_SHARE * (area / loss));
        }
    }
    return share;
}

@compute @workgroup_size(64)
fn sweep(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= params.count) {
        return;
    }
    let v = vertices[params.first + id.x];
    let start = fan_starts[v];
    let end = fan_starts[v + 1u];
    let here = positions[v];
    let step = newton(start, end, here);
    let before = fan_energy(start, end, here);
    var share = safe_share(start, end, here, step);
    for (var i = 0u; i < TRIES; i += 1u) {
        let to = vec4<f32>(here.xy, here.z + share * step.x, here.w + share * step.y);
        if (fan_energy(start, end, to) < before) {
            positions[v] = to;
            return;
        }
        share = share * 0.5;
    }
}
