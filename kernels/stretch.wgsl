// Stretch of every triangle: singular values of the affine map from positions `source` to positions `image`.
// Reference: src/kernel/stretch.rs.

// Edges are measured in units of their triangle's longest component, and that unit must lie in this range: beyond it,
// areas leave the range of f32.
const MIN_LENGTH: f32 = 1e-12;
const MAX_LENGTH: f32 = 1e12;
// Twice the area, in those units, below which a triangle has no height: coordinates of order one in f32 say nothing
// about shorter heights, and squares of what is divided by it would leave the range of f32.
const MIN_DOUBLE_AREA: f32 = 1e-8;
// Squares below this count as zero, so that devices which flush denormal numbers agree with those which do not.
const MIN_SQUARE: f32 = 1e-24;

@group(0) @binding(0) var<uniform> params: Span;
@group(0) @binding(1) var<storage, read> triangles: array<Triangle>;
@group(0) @binding(2) var<storage, read> source: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> image: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read_write> stretches: array<Stretch>;

// Products are written out: the order of additions is then the same on every device.
fn dot3(a: vec3<f32>, b: vec3<f32>) -> f32 {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

fn double_area(u: vec3<f32>, w: vec3<f32>) -> f32 {
    let n = vec3<f32>(u.y * w.z - u.z * w.y, u.z * w.x - u.x * w.z, u.x * w.y - u.y * w.x);
    let square = dot3(n, n);
    return select(0.0, sqrt(square), square >= MIN_SQUARE);
}

fn longest(u: vec3<f32>, w: vec3<f32>) -> f32 {
    let m = max(abs(u), abs(w));
    return max(max(m.x, m.y), m.z);
}

// Singular values of the map that takes edges u, w (spanning `twice` the triangle's area) to edges p, q.
fn singular_values(u: vec3<f32>, w: vec3<f32>, twice: f32, p: vec3<f32>, q: vec3<f32>, image_twice: f32) -> vec2<f32> {
    let width = sqrt(dot3(u, u));
    let per_width = 1.0 / width;
    let per_area = 1.0 / twice;
    let x = p * per_width;
    let shear = dot3(u, w) * per_width;
    let y = (q - x * shear) * (width * per_area);
    let a = dot3(x, x);
    let b = dot3(x, y);
    let c = dot3(y, y);
    let large = sqrt((a + c + sqrt((a - c) * (a - c) + 4.0 * (b * b))) * 0.5);
    if (!(large > 0.0)) {
        return vec2<f32>(0.0, 0.0);
    }
    return vec2<f32>(large, min(image_twice * per_area / large, large));
}

@compute @workgroup_size(64)
fn stretch(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= params.count) {
        return;
    }
    let f = params.first + id.x;
    let t = triangles[f];
    let u = source[t.b].xyz - source[t.a].xyz;
    let w = source[t.c].xyz - source[t.a].xyz;
    let p = image[t.b].xyz - image[t.a].xyz;
    let q = image[t.c].xyz - image[t.a].xyz;
    let unit = longest(u, w);
    let image_unit = longest(p, q);
    var result = Stretch(0.0, 0.0, 0.0, 0.0);
    if (unit >= MIN_LENGTH && unit <= MAX_LENGTH && image_unit <= MAX_LENGTH) {
        let per_unit = 1.0 / unit;
        let su = u * per_unit;
        let sw = w * per_unit;
        let twice = double_area(su, sw);
        if (twice >= MIN_DOUBLE_AREA) {
            result.area_from = 0.5 * twice * unit * unit;
        }
        if (image_unit >= MIN_LENGTH) {
            let per_image_unit = 1.0 / image_unit;
            let sp = p * per_image_unit;
            let sq = q * per_image_unit;
            let image_twice = double_area(sp, sq);
            result.area_to = 0.5 * image_twice * image_unit * image_unit;
            if (twice >= MIN_DOUBLE_AREA) {
                let s = singular_values(su, sw, twice, sp, sq, image_twice);
                let ratio = image_unit / unit;
                result.large = s.x * ratio;
                result.small = s.y * ratio;
            }
        }
    }
    stretches[f] = result;
}
