// Stretch at every vertex: the mean stretch of its triangles, weighted by their areas in the image, and what the
// relaxation makes of it. Reference: src/kernel/vertex_stretch.rs.

// The mean is kept in this range, so that its powers, and weights divided by them, stay positive and finite.
const MIN_MEAN: f32 = 1e-6;
const MAX_MEAN: f32 = 1e6;

struct VertexStretchParams {
    // The vertices of this dispatch: first .. first + count.
    first: u32,
    count: u32,
    // 0: sigma becomes the mean. 1 to 3: sigma becomes the geometric mean of its old value and this power of the mean.
    power: u32,
    unused: u32,
}

@group(0) @binding(0) var<uniform> params: VertexStretchParams;
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
        mean = min(max(weighted / area, MIN_MEAN), MAX_MEAN);
    }
    if (params.power == 0u) {
        sigma[v] = mean;
        return;
    }
    var product = sigma[v];
    for (var i = 0u; i < params.power; i += 1u) {
        product = product * mean;
    }
    sigma[v] = sqrt(product);
}
