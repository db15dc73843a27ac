// Barycentric resampling: every query is the weighted sum of a vertex attribute at three vertices.
// Reference: src/kernel/resample.rs.

@group(0) @binding(0) var<uniform> params: Span;
@group(0) @binding(1) var<storage, read> queries: array<Query>;
@group(0) @binding(2) var<storage, read> values: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read_write> samples: array<vec4<f32>>;

// Three vertices and their barycentric weights, which sum to one.
struct Query {
    i0: u32,
    i1: u32,
    i2: u32,
    w0: f32,
    w1: f32,
    w2: f32,
}

@compute @workgroup_size(64)
fn resample(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= params.count) {
        return;
    }
    let i = params.first + id.x;
    let q = queries[i];
    samples[i] = q.w0 * values[q.i0] + q.w1 * values[q.i1] + q.w2 * values[q.i2];
}
