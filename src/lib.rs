//! `homeo`: certified bijective, low-distortion maps between triangle meshes.
//!
//! A job is two meshes of the same genus, with as many boundary loops, and corresponding landmarks. Its product is a
//! [`map`] that gives every point of either mesh one point of the other, proved to be a bijection, and what follows from
//! it: compatible meshes, tables of corresponding points, geometry images over a common atlas.
//!
//! # The main job
//!
//! Every stage takes a value and makes the next; [`pipeline::stages`] lists them, [`stage`] holds one file for each.
//!
//! ```text
//!  two files, landmarks, hint
//!        | load       vertices keep their order and number            mesh::io
//!        | check      two manifolds of the same kind, or exit 3 or 4   mesh::check, path::handedness
//!        |            from here on in canonical order                 mesh::canonical
//!        | simplify   large meshes become small ones, with a way back    mesh::simplify
//!        | cluster    the landmarks' surface Voronoi cells             path::front, path::cluster
//!        | trace      arcs on one mesh, carried over to the other,     path::search, path::region
//!        |            or laid on both, led by a rough map              stage::growth, stage::hypothesis
//!        v
//!      Layout         one base complex, two cut meshes
//!        | embed      every patch into its base triangle               plane::convex
//!        | stretch    all patches at once, on the compute device       kernel, gpu
//!        | relax      across the arcs, which move with it and flip,    plane::domain, plane::thin, plane::hierarchy, plane::smooth
//!        |            single moves of all domains on the device,       kernel::sweep_batch
//!        |            then the compatible meshes themselves            plane::polish
//!        | lift       back to the large meshes                         path::lift, plane::convex
//!        v
//!     Embedding       source patches -> base complex <- target patches
//!        | compose    follow it through; certify                       map::surface_map, map::certificate
//!        v
//!    SurfaceMap       for every vertex a face of the other mesh and barycentric coordinates
//!        | refine     vertices where compatible meshes miss, if wanted mesh::subdivision, mesh::salience, map::lift
//!        | bake       sample both meshes over one atlas                map::atlas, kernel::resample
//!        |            from here on in the files' order
//!        | write      a folder that appears complete or not at all     map::report, view
//!        v
//!   compatible meshes, CSV, layout.json, geometry/*.exr, report.json; report.html and preview.png to look at
//! ```
//!
//! [`pipeline`] runs the stages, each on threads of its own, with many pairs in flight; [`pipeline::batch`] does so for a
//! night's worth of them, and remembers what is done. Long loops ask [`deadline`] whether there is time left.
//!
//! # Other jobs
//!
//! They stand in [`app`]. [`app::rebuild`] reads a geometry image back as a mesh: pixels that sample one point become one
//! vertex, by the tile table in the image and never by position, so the mesh is as closed as the surface. [`app::bake`] draws a
//! mesh's values in its own texture coordinates, [`app::transfer`] an image of one mesh in those of the other, and
//! [`app::morph`] puts finished maps into one file as morph targets. [`app::diffusion`] gives the regions of a mesh coordinates
//! by fronts from their sides ([`path::side_front`]), and maps equal regions of two meshes onto each other.
//! [`app::constrained`] lays a disc onto an image with vertices exactly where the user wants them; where they cannot walk
//! there, a base mesh over their places takes the disc along. [`picture::render`] draws previews, and [`view`] makes the pages
//! that show results.
//!
//! # Who may import whom
//!
//! ```text
//! cli -> pipeline -> app, stage, shape -> view -> map, kernel -> path, plane, solve, picture, gpu -> mesh -> deadline -> error
//! ```
//!
//! Nothing imports upwards, and every outside crate has one door; a test reads the `use` lines. The device proposes in
//! single precision; topology and injectivity are decided on the CPU, in double precision with exact predicates.
//!
//! # Why the map is a bijection
//!
//! A finished map is a homeomorphism because (a) both layouts carry the same base complex, (b) every patch of both cut
//! meshes is a disc, and (c) every triangle of every patch has exactly positive orientation in its base triangle, with
//! the boundary vertices in order along its sides. [`map::certificate`] checks all three on the stored data at the end
//! of every run; whatever moves an embedding before steps back when (c) would fail.
//!
//! # Why there always is a layout
//!
//! After every arc both meshes have the same *region structure*: for each region its boundary walks, the landmarks
//! inside and its genus. An arc that joins two boundary walks or loose landmarks cannot block another one, nor can an arc
//! that opens a handle: a shortest path that crosses some closed curve an odd number of times, so that it does not
//! separate. An arc that separates a region is taken only if both sides agree on both meshes, and is postponed otherwise.
//! When only postponed arcs are left, joining ones go first, then those that open a handle; then every region is a disc,
//! in which each arc has one way to go.
//! Boundary loops carry arcs before any other is traced ([`path::rim`]), so they are walks like the others; so do guides,
//! which are taken only if they leave the same region structure ([`stage::check::Guides`]).
//!
//! # Glossary
//!
//! | word | meaning |
//! | --- | --- |
//! | landmark | a pair of corresponding vertices that the user gives |
//! | cluster | surface Voronoi cell of a landmark |
//! | cut | a run of edges along which two clusters touch |
//! | arc | a curve on a mesh between two landmarks: the image of an edge of the base complex |
//! | base complex | abstract triangles over the landmarks; several edges may join the same two, and an edge may be a loop |
//! | rim | an arc along a boundary loop; rims are given, and never move |
//! | guide | a closed curve of a hint; arcs along it are given, and move later |
//! | layout | the base complex and its arcs on both meshes |
//! | region | what arcs leave connected |
//! | rough map | the source draped over the target before there is a layout; path hypotheses come from it |
//! | patch | a disc bounded by three arcs: the image of a triangle of the base complex |
//! | cut mesh | a mesh refined so that arcs run along its edges; every vertex knows its place on the original |
//! | dividing edge | an inner edge between two vertices of one side of a patch; it is split |
//! | reference triangle | (0,0), (1,0), (0,1): where patches are embedded |
//! | frame | the triangle in the plane, with the arcs' lengths as sides, in which a patch's stretch is measured |
//! | embedding | positions of a patch's vertices in its reference triangle |
//! | domain | the part of the plane in which a patch, or the patches around a base vertex or at an arc, are relaxed |
//! | sample | what a compatible mesh has of the map: the image of a vertex, and the triangle between three of them |
//! | canonical order | vertices and faces along a space-filling curve: ties are decided alike whatever order they came in |
//! | map | source patch -> base triangle -> target patch |
//! | compatible mesh | one mesh's vertices and faces at the other's shape |
//! | side, corner | of a region with coordinates: u or v is 0 or 1 on a side, both are at a corner |
//! | fold, pinned triangle | turned over in (u, v); without room beside a straight side |
//! | atlas, tile | the squares over which both meshes are sampled; a tile holds two patches, or one |
//!
//! # Measures
//!
//! For the affine map of a triangle let `G >= g` be its singular values after the one scale that makes both total areas
//! equal, `A` its area before and `B` after. `E_L2 = sqrt(sum B (G^2 + g^2) / 2 / sum B)`; symmetric Dirichlet energy
//! `sum A (G^2 + g^2 + 1/G^2 + 1/g^2) / 4 / sum A`; both are 1 for an isometry up to scale and more otherwise. `E_ang` is
//! the mean change of the corners' angles in radians, weighted by `A`. A triangle of a compatible mesh is *turned over*
//! if its normal opposes all of the target near its middle: [`map::flips`].
//!
//! # References
//!
//! Short names stand in the docs of the modules that follow them.
//!
//! - VORONOI: Kwok, Zhang, Wang, "Constructing common base domain by cues from Voronoi diagram": clusters, cuts, edge
//!   nodes, the order of arcs.
//! - HYPOTHESIS: Pan, Wu, Pan, Yang, "A novel scheme for efficient cross-parameterization": swirls, path hypotheses,
//!   relaxation in the quad of two patches, active refinement.
//! - DIFFUSION: Schmidt, Guthe, Blanz, "Diffusion-based parametrization of surfaces on 3D-meshes": fronts from the sides of
//!   regions, (u, v) by ratios of distances.
//! - Bornemann, Rasch, "Finite-element discretization of static Hamilton-Jacobi equations based on a local variational
//!   principle" (2006): fronts across faces.
//! - Kraevoy, Sheffer, "Cross-parameterization and compatible remeshing of 3D models" (2004), and Praun, Sweldens,
//!   Schröder, "Consistent mesh parameterizations" (2001): maps through a common base complex.
//! - Floater, "Mean value coordinates" (2003), and Tutte, "How to draw a graph" (1963): embeddings by positive weights.
//! - Yoshizawa, Belyaev, Seidel, "A fast and simple stretch-minimizing mesh parameterization" (2004).
//! - Shen, Jiang, Zorin, Panozzo, "Progressive embedding" (2019): collapsed vertices brought back into positive triangles.
//! - Sander, Snyder, Gortler, Hoppe, "Texture mapping progressive meshes" (2001): the L2 stretch.
//! - Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric predicates" (1997).
//! - Gu, Gortler, Hoppe, "Geometry images" (2002).

pub mod app;
pub mod cli;
pub mod deadline;
pub mod error;
pub mod gpu;
pub mod kernel;
pub mod map;
pub mod mesh;
pub mod path;
pub mod picture;
pub mod pipeline;
pub mod plane;
pub mod shape;
pub mod solve;
pub mod stage;
pub mod view;

pub use error::{Error, ErrorKind, Result};
