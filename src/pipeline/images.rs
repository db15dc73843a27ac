//! The geometry images of a finished map: joins the atlas, the map and the kernels to the bake stage.

use super::thumbnails::thumbnails;
use crate::error::{Error, Result};
use crate::gpu::Compute;
use crate::kernel::{self, Lanes, Lists, vertex_stretch::vertex_stretch};
use crate::map::atlas::{Atlas, BaseSample};
use crate::map::embedding::EmbeddedMesh;
use crate::map::file_order::Onto;
use crate::map::product::{GeometryImages, NamedFile};
use crate::map::surface_map::{Chart, SurfaceMap};
use crate::map::tile_table::TileTable;
use crate::mesh::{FaceId, Id, IdVec, SurfacePoint, TriMesh, VertexId};
use crate::path::base_complex::BaseComplex;
use crate::stage::bake::{BakedImage, Query, Sampled, bake, encode_layered};
use crate::stage::check::{Checked, LoadedMesh};
use crate::stage::compose::{Composed, base_in_file_terms};
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// The images with `size` samples along a tile's side, each in a file of its own unless `layered`; none if `size` is 0. And
/// what they look like, with captions.
///
/// The tile table speaks of the landmarks by their numbers in the file, like everything that is written.
pub fn geometry_images(
    compute: &Compute,
    checked: &Checked,
    composed: &Composed,
    size: usize,
    layered: bool,
) -> Result<(Option<GeometryImages>, Vec<NamedFile>)> {
    if size == 0 {
        return Ok((None, Vec::new()));
    }
    let (meshes, base) = (checked.meshes(), &composed.embedding.base);
    let atlas = Atlas::new(base, size, None)?;
    let samples: Vec<BaseSample> = atlas.samples(base).map(|(_, sample)| sample).collect();
    let points = |k: usize| sample_points(meshes[k], &composed.embedding.meshes[k], base, &samples);
    let (on_source, on_target) = (points(0)?, points(1)?);
    let stretch = stretch_at_vertices(compute, meshes, &composed.maps[0])?;
    let resample = |values: &[Lanes], queries: &[Query]| {
        let query = |&([i0, i1, i2], [w0, w1, w2]): &Query| kernel::Query { i0, i1, i2, w0, w1, w2 };
        kernel::resample(compute, &queries.iter().map(query).collect::<Vec<_>>(), values)
    };
    let (source_uv, target_uv) = (sample_uv(&checked.source, &on_source), sample_uv(&checked.target, &on_target));
    let source = Sampled { mesh: meshes[0], points: &on_source, uv: source_uv.as_deref() };
    let target = Sampled { mesh: meshes[1], points: &on_target, uv: target_uv.as_deref() };
    let table = TileTable::new(&atlas, &base_in_file_terms(checked, base.clone()));
    let images = bake(base, &atlas, source, target, &stretch, &resample)?;
    let file = |image: &BakedImage| Ok((format!("{}.exr", image.name), image.encode(&table)?));
    let files = if layered {
        vec![("geometry.exr".to_string(), encode_layered(&images, &table)?)]
    } else {
        images.iter().map(file).collect::<Result<_>>()?
    };
    Ok((Some(GeometryImages { table, files }), thumbnails(&images)))
}

/// The places of the samples on a mesh.
fn sample_points(
    mesh: &TriMesh,
    embedded: &EmbeddedMesh,
    base: &BaseComplex,
    samples: &[BaseSample],
) -> Result<Vec<(FaceId, [f64; 3])>> {
    let chart = Chart::new(mesh, embedded, base);
    let place = |&sample: &BaseSample| {
        let point = chart.point(sample)?;
        point.on_face(mesh).ok_or_else(|| Error::bug(format!("a sample lies on no face, {point:?}")))
    };
    samples.par_iter().map(place).collect()
}

/// The texture coordinates at points of a mesh's canonical order; none if it has none, zero in triangles without.
fn sample_uv(
    LoadedMesh { file, mesh, omitted, canonical, .. }: &LoadedMesh,
    points: &[(FaceId, [f64; 3])],
) -> Option<Vec<[f32; 2]>> {
    if file.uv.values.is_empty() {
        return None;
    }
    let triangles = file.triangles();
    let corners: Vec<[usize; 3]> = file.triangle_corners().collect();
    let onto = Onto { mesh, triangles: &triangles, omitted };
    let uv = |&(f, b): &(FaceId, [f64; 3])| {
        let SurfacePoint::Face(there, b) = canonical.point_there(SurfacePoint::Face(f, b)) else {
            unreachable!("a point in a face is one in the other order")
        };
        let (number, b) = onto.to_file_order(there, b);
        let weighted = corners[number.index()].into_iter().zip(b);
        let uv: Option<DVec2> = weighted.map(|(c, b)| file.uv.at(c).map(|uv| uv * b)).sum();
        uv.unwrap_or_default().as_vec2().to_array()
    };
    Some(points.par_iter().map(uv).collect())
}

/// The L2 stretch of the map at every source vertex, after the scale that makes both areas equal.
fn stretch_at_vertices(
    compute: &Compute,
    [source, target]: [&TriMesh; 2],
    map: &SurfaceMap,
) -> Result<IdVec<VertexId, f64>> {
    let image: Vec<DVec3> = map.images.iter().map(|p| p.map_or(DVec3::ZERO, |p| p.position(target))).collect();
    let faces = source.faces();
    let area = |p: &[DVec3]| faces.iter().map(|t| crate::mesh::metric::area(t.map(|v| p[v.0 as usize]))).sum::<f64>();
    let lanes = |p: &[DVec3]| -> Vec<Lanes> {
        let unit = area(p).sqrt().recip();
        p.iter().map(|p| (*p * unit).as_vec3().extend(0.0).to_array()).collect()
    };
    let triangles: Vec<[u32; 3]> = faces.iter().map(|t| t.map(|v| v.0)).collect();
    let stretches = kernel::stretch(compute, &triangles, &lanes(&source.positions.raw), &lanes(&image))?;
    let incident = Lists::incident(image.len(), &triangles)?;
    let mean = vertex_stretch(compute, &incident, &stretches, &vec![1.0; image.len()], 0)?;
    Ok(mean.into_iter().map(f64::from).collect())
}
