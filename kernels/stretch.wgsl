// Stretch of every triangle: singular values of the affine map from positions `source` to positions `image`.
// Reference: src/kernel/stretch.rs.

// The longest component of a triangle's edges must lie in this range: beyond it, areas leave the range of f32. Edges are
// measured in units of the largest power of two not above it, which is exact.
const MIN_LENGTH: f32 = 1e-12;
const MAX_LENGTH: f32 = 1e12;
// Twice the area, in those units, below which a triangle has no height: coordinates of order one in f32 say nothing
// about shorter heights, and squares of what is divided by it would leave the range of f32.
const MIN_DOUBLE_AREA: f32 = 1e-8;
// Squares below this count as zero, so that devices which flush denormal numbers agree with those which do not.
const MIN_SQUARE: f32 = 1e-24;
// The exponents of a power of two and of one divided by it have this sum, where f32 has them.
const POWERS: u32 = 0x7f000000u;

@group(0) @binding(0) var<uniform> params: Span;
@group(0) @binding(1) var<storage, read> triangles: array<Triangle>;
@group(0) @binding(2) var<storage, read> source: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> image: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read_write> stretches: array<Stretch>;

// Products are written out: the order of additions is then the same on every device.
fn dot3(a: vec3<f32>, b: vec3<f32>) -> f32 {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

fn double_area_squared(u: vec3<f32>, w: vec3<f32>) -> f32 {
    let n = vec3<f32>(u.y * w.z - u.z * w.y, u.z * w.x - u.x * w.z, u.x * w.y - u.y * w.x);
    let square = dot3(n, n);
    return select(0.0, square, square >= MIN_SQUARE);
}

fn longest(u: vec3<f32>, w: vec3<f32>) -> f32 {
    let m = max(abs(u), abs(w));
    return max(max(m.x, m.y), m.z);
}

// The exponent of the largest power of two not above a positive normal number, where f32 has it.
fn exponent(x: f32) -> u32 {
    return bitcast<u32>(x) & 0x7f800000u;
}

// The larger singular value of the map that takes edges u, w (with `square` for the square of twice the triangle's area) to
// edges p, q.
fn larger_value(u: vec3<f32>, w: vec3<f32>, square: f32, p: vec3<f32>, q: vec3<f32>) -> f32 {
    let width = dot3(u, u);
    let both = 1.0 / (width * square);
    let per_width = both * square;
    let per_square = both * width;
    let y = q - p * (dot3(u, w) * per_width);
    let a = dot3(p, p) * per_width;
    let b = dot3(p, y);
    let c = dot3(y, y) * (width * per_square);
    let half = 0.5 * (a - c);
    return sqrt(0.5 * (a + c) + sqrt(half * half + b * (b * per_square)));
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
    let length = longest(u, w);
    let image_length = longest(p, q);
    var result = Stretch(0.0, 0.0, 0.0, 0.0);
    if (length >= MIN_LENGTH && length <= MAX_LENGTH && image_length <= MAX_LENGTH) {
        let power = exponent(length);
        let unit = bitcast<f32>(power);
        let per_unit = bitcast<f32>(POWERS - power);
        let su = u * per_unit;
        let sw = w * per_unit;
        let square = double_area_squared(su, sw);
        let has_area = square >= MIN_DOUBLE_AREA * MIN_DOUBLE_AREA;
        let twice = sqrt(square);
        if (has_area) {
            result.area_from = 0.5 * twice * unit * unit;
        }
        if (image_length >= MIN_LENGTH) {
            let image_power = exponent(image_length);
            let image_unit = bitcast<f32>(image_power);
            let per_image_unit = bitcast<f32>(POWERS - image_power);
            let sp = p * per_image_unit;
            let sq = q * per_image_unit;
            let image_twice = sqrt(double_area_squared(sp, sq));
            result.area_to = 0.5 * image_twice * image_unit * image_unit;
            if (has_area) {
                let large = larger_value(su, sw, square, sp, sq);
                let ratio = image_unit * per_unit;
                if (large > 0.0) {
                    result.large = large * ratio;
                    result.small = min(image_twice / (twice * large), large) * ratio;
                }
            }
        }
    }
    stretches[f] = result;
}
