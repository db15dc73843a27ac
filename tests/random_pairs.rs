//! Random pairs are of the kind that was asked for, and the same every time.

use homeo::mesh::check::check;
use homeo::shape::{PairOptions, random_pair};

#[test]
fn pairs_have_the_genus_loops_and_landmarks_wished_for() {
    for (genus, loops, landmarks, related) in [
        (0, 0, 3, true),
        (0, 3, 10, false),
        (1, 0, 5, false),
        (1, 2, 60, true),
        (2, 1, 8, true),
        (3, 0, 20, true),
        (3, 3, 4, false),
    ] {
        let options = PairOptions { genus, loops, landmarks, vertices: [900, 700], related };
        let pair = random_pair(&options, 11);
        for (mesh, chosen) in pair.meshes.iter().zip(&pair.landmarks) {
            let report = check(&mesh.positions.raw, &mesh.faces());
            assert_eq!((report.genus, report.components.len()), (Some(genus as i64), 1), "{options:?}: {report}");
            assert_eq!(report.boundary_loops.len(), loops, "{options:?}: {report}");
            let mut different = chosen.clone();
            different.sort_unstable();
            different.dedup();
            assert_eq!((chosen.len(), different.len()), (landmarks, landmarks), "{options:?}");
            assert!(chosen.iter().all(|&v| mesh.conn.leaving(v).is_some()), "{options:?}: a landmark on no face");
        }
    }
}

#[test]
fn equal_seeds_give_equal_pairs() {
    let options = PairOptions { genus: 0, loops: 1, landmarks: 9, vertices: [700, 650], related: true };
    let [a, b, c] = [5, 5, 6].map(|seed| random_pair(&options, seed));
    for k in 0..2 {
        assert_eq!(a.meshes[k].positions.raw, b.meshes[k].positions.raw);
        assert_eq!((a.meshes[k].faces(), &a.landmarks[k]), (b.meshes[k].faces(), &b.landmarks[k]));
        assert_ne!(a.meshes[k].positions.raw, c.meshes[k].positions.raw);
    }
}
