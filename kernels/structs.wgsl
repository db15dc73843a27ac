// Structs shared by several kernels; this file is put before each of them. Their Rust twins carry the same names and
// field names, and a test compares the two layouts.

// The elements one dispatch covers.
struct Span {
    first: u32,
    count: u32,
}

// Corners of a triangle, counter-clockwise.
struct Triangle {
    a: u32,
    b: u32,
    c: u32,
}

// How an affine map stretches one triangle: singular values large >= small, and the areas before and after.
// area_from = 0 marks a triangle without a usable area before; then large = small = 0 as well.
struct Stretch {
    large: f32,
    small: f32,
    area_from: f32,
    area_to: f32,
}
