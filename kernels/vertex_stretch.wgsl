// Stretch at every vertex: the mean stretch of its triangles, weighted by their areas in the image.
// Reference: src/kernel/vertex_stretch.rs.

// A vertex stretch is kept in this range, so that weights divided by it stay positive and finite.
const MIN_SIGMA: f32 = 1e-12;
const MAX_SIGMA: f32 = 1e12;

@group(0) @binding(0) var<uniform> params: Span;
@group(0) @binding(1) var<storage, read> starts: array<u32>;
@group(0) @binding(2) var<storage, read> incident: array<u32>;
@group(0) @binding(3) var<storage, read> stretches: array<Stretch>;
@group(0) @binding(4) var<storage, read_write> sigma: array<f32>;

@compute @workgroup_size(64)
fn vertex_stretch(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= params.count) {
        return;
    }
    let v = params.first + id.x;
    var weighted = 0.0;
    var area = 0.0;
    for (var k = starts[v]; k < starts[v + 1u]; k += 1u) {
        let s = stretches[incident[k]];
        if (s.large > 0.0) {
            let ratio = s.small / s.large;
            weighted += s.area_to * (s.large * sqrt(0.5 * (1.0 + ratio * ratio)));
            area += s.area_to;
        }
    }
    var mean = 1.0;
    if (area > 0.0) {
        mean = min(max(weighted / area, MIN_SIGMA), MAX_SIGMA);
    }
    sigma[v] = mean;
}
