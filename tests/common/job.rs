//! Whole maps, as the main job makes them, and what must hold for every one.

use homeo::Result;
use homeo::gpu::{Device, DeviceChoice};
use homeo::mesh::{Id, SurfacePoint, TriMesh, VertexId};
use homeo::pipeline::{MapOptions, Mapped, Silent, map_pairs};
use homeo::stage::load::Loaded;

/// Maps a pair by the main job's stages with their defaults.
pub fn map(meshes: [&TriMesh; 2], landmarks: [&[VertexId]; 2]) -> Result<Mapped> {
    map_loaded(Loaded::of(meshes, landmarks))
}

/// The same for a pair as it was read.
pub fn map_loaded(pair: Loaded) -> Result<Mapped> {
    let device = Device::open(&DeviceChoice::Cpu)?;
    let mut outcomes = Vec::new();
    let pairs = std::iter::once(pair);
    map_pairs(pairs, &MapOptions::default(), &device, &Silent, |outcome| outcomes.push(outcome.value));
    outcomes.pop().expect("one pair has one outcome")
}

/// Certified; landmarks meet; every vertex has an image in a face; Euler's counts of arcs and patches.
pub fn assert_sound(mapped: &Mapped, name: &str) {
    assert!(mapped.map.certificate.bijective, "{name}: {:?}", mapped.map.certificate);
    let checked = &mapped.checked;
    let meshes = [&checked.source.mesh, &checked.target.mesh];
    let sites = [&checked.landmarks.source, &checked.landmarks.target];
    for k in 0..2 {
        let images = &mapped.map.maps[k].images;
        assert_eq!(images.len(), meshes[k].positions.len(), "{name}");
        for (v, image) in images.iter_ids().filter(|(v, _)| meshes[k].conn.leaving(*v).is_some()) {
            let (_, b) = image.and_then(|p| p.on_face(meshes[1 - k])).unwrap_or_else(|| panic!("{name}: {v} is lost"));
            assert!(b.iter().all(|&x| x >= 0.0) && (b.iter().sum::<f64>() - 1.0).abs() < 1e-12, "{name}: {v} at {b:?}");
        }
        for (&from, &to) in sites[k].iter().zip(sites[1 - k]) {
            assert_eq!(images[from], Some(SurfacePoint::Vertex(to)), "{name}: landmark {from}");
        }
    }
    euler(mapped, name);
    let energies = &mapped.relaxation.energies;
    assert!(energies.iter().all(|e| e.is_finite() && *e > 0.99), "{name}: {energies:?}");
}

/// V - E + F of the base complex is that of the surface.
fn euler(mapped: &Mapped, name: &str) {
    let report = &mapped.checked.source.report;
    let base = &mapped.map.base;
    let sum = base.landmarks as i64 - base.arcs.len() as i64 + base.patches.len() as i64;
    let expected: i64 = report.components.iter().map(|c| c.euler).sum();
    assert_eq!(sum, expected, "{name}: base complex with {} vertices", base.landmarks);
    if report.is_closed() {
        assert_eq!(2 * base.arcs.len(), 3 * base.patches.len(), "{name}: every arc has two sides");
    }
    assert!(base.landmarks >= mapped.checked.landmarks.names.len(), "{name}");
    assert!(base.arcs.iter().flatten().all(|l| l.index() < base.landmarks), "{name}");
}
