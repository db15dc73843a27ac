//! What lies between the curves.

use super::super::SIDES;
use super::{Guides, Guiding};
use crate::mesh::{ArcId, HalfedgeId, Id, LandmarkId, VertexId};
use crate::path::base_complex::DirectedArc;
use crate::path::cut_mesh::CutMesh;
use crate::path::edge_loop::GivenArc;
use crate::path::region::Regions;
use crate::{Error, Result};
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// Sides of a patch: a disc between arcs with fewer is none.
const LEAST_SIDES: usize = 3;

/// A region between arcs, told without reference to the mesh.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Region {
    /// Its boundary walks, each from its lowest arc on, in order.
    walks: Vec<Vec<DirectedArc>>,
    /// The landmarks inside, in order.
    inside: Vec<LandmarkId>,
    genus: i64,
}

impl Region {
    fn all(regions: &Regions) -> Vec<Region> {
        let one = |r: usize| {
            let mut walks = regions.walks[r].clone();
            for walk in &mut walks {
                let first = (0..walk.len()).min_by_key(|&i| walk[i]).unwrap_or(0);
                walk.rotate_left(first);
            }
            walks.sort();
            let mut inside = regions.isolated[r].clone();
            inside.sort_unstable();
            Region { walks, inside, genus: regions.genus[r] }
        };
        (0..regions.walks.len()).map(one).collect()
    }

    /// The walk with an arc.
    fn walk(&self, d: DirectedArc) -> Option<&Vec<DirectedArc>> {
        self.walks.iter().find(|walk| walk.contains(&d))
    }
}

/// For every given arc the curve that it is a part of; none for rims.
struct Owners(Vec<Option<usize>>);

impl Owners {
    fn new(given: &[GivenArc], curves: &[Vec<HalfedgeId>]) -> Self {
        let numbered = curves.iter().enumerate().flat_map(|(i, curve)| curve.iter().map(move |&h| (h, i)));
        let owner: HashMap<HalfedgeId, usize> = numbered.collect();
        Owners(given.iter().map(|arc| owner.get(arc.halfedges.first()?).copied()).collect())
    }

    fn of(&self, d: DirectedArc) -> Option<usize> {
        self.0[d.arc.index()]
    }
}

impl Guiding<'_> {
    /// Completes guides with the regions between them, if these are the same on both meshes.
    pub(super) fn compare(&self, guides: Guides, base: &[Vec<VertexId>; 2]) -> Result<Guides> {
        let meshes = self.loaded.map(|l| &l.canonical.mesh);
        let given = [0, 1].map(|k| guides.given_arcs(k, meshes[k], &base[k]));
        let found = [0, 1].map(|k| {
            let mut cut = CutMesh::new(meshes[k], &base[k], 1);
            given[k].iter().enumerate().for_each(|(i, arc)| arc.lay(&mut cut, ArcId::new(i)));
            Regions::find(&cut)
        });
        let owners = Owners::new(&given[0], &guides.loops[0]);
        let [source, target] = found.each_ref().map(Region::all);
        self.refuse_slits(&source, &owners)?;
        let number: BTreeMap<&Region, u32> = source.iter().zip(0..).collect();
        let partner: Option<Vec<u32>> = target.iter().map(|region| number.get(region).copied()).collect();
        let Some(partner) = partner.filter(|_| source.len() == target.len()) else {
            return Err(self.explain([&source, &target], &owners));
        };
        let curves = |walk: &&Vec<DirectedArc>| walk.iter().any(|&d| owners.of(d).is_some());
        let open = source.iter().any(|r| r.genus > 0 || r.walks.iter().filter(curves).count() > 1);
        let [on_source, on_target] = found.map(|regions| regions.of_face);
        let region = [on_source, on_target.iter().map(|&r| partner[r as usize]).collect()];
        Ok(Guides { region, open, ..guides })
    }

    /// Refuses curves that meet twice with nothing between.
    fn refuse_slits(&self, regions: &[Region], owners: &Owners) -> Result<()> {
        for region in regions.iter().filter(|r| r.genus == 0 && r.inside.is_empty()) {
            let [walk] = region.walks.as_slice() else { continue };
            if walk.len() < LEAST_SIDES {
                let what = format!("{} enclose nothing between two meetings", self.names(walk, owners));
                return Err(Error::input(what).remedy("pull them apart there"));
            }
        }
        Ok(())
    }

    fn names(&self, walk: &[DirectedArc], owners: &Owners) -> String {
        let curves: BTreeSet<usize> = walk.iter().filter_map(|&d| owners.of(d)).collect();
        let names: Vec<String> = curves.into_iter().map(|i| self.name(i)).collect();
        names.join(" and ")
    }

    /// What is different on the target.
    fn explain(&self, [source, target]: [&[Region]; 2], owners: &Owners) -> Error {
        let sides = source.iter().filter(|r| !target.contains(r)).flat_map(|r| r.walks.concat());
        let along = sides.filter_map(|d| Some((d, owners.of(d)?)));
        for (d, curve) in along {
            let [Some(here), Some(there)] = [source, target].map(|all| all.iter().find(|r| r.walk(d).is_some())) else {
                continue;
            };
            if here.walk(d) != there.walk(d) {
                let names = self.names(here.walk(d).map_or(&[], Vec::as_slice), owners);
                return Error::unsolvable(format!("{names} meet another way round on the target"))
                    .remedy("list one of them in the opposite direction on one mesh, or move it");
            }
            let hand = if d.reversed { "right" } else { "left" };
            let [first, second] = [here, there].map(|r| self.describe(r, owners));
            if first != second {
                let what = format!(
                    "{hand} of {} the {} has {first}, the {} has {second}",
                    self.name(curve),
                    SIDES[0],
                    SIDES[1]
                );
                return Error::unsolvable(what).remedy("list it in the same direction on both meshes, or move it");
            }
        }
        Error::unsolvable("the loops divide the two meshes in different ways").remedy("move them")
    }

    /// A region in words.
    fn describe(&self, region: &Region, owners: &Owners) -> String {
        let mut parts = vec![format!("genus {}", region.genus)];
        let names: Vec<String> = region.inside.iter().filter_map(|l| self.landmark(*l)).collect();
        parts.push(if names.is_empty() { "no landmark".to_owned() } else { format!("landmarks {}", names.join(", ")) });
        let around: Vec<String> = region.walks.iter().map(|walk| self.names(walk, owners)).collect();
        let around: Vec<String> = around.into_iter().filter(|names| !names.is_empty()).collect();
        parts.push(format!("{} side{} of a loop around it", around.len(), if around.len() == 1 { "" } else { "s" }));
        parts.join(", ")
    }
}
