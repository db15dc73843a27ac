//! A mesh whose vertices move in a domain so that the symmetric Dirichlet energy of a map falls.
//!
//! Looking at what lies below is dear, so it is done once and a model is kept: every triangle goes on seeing the metrics it
//! saw. Moves lower the model; [`Smoother::settle`] then looks again and takes back as much as it must for the energy
//! itself to have fallen.

use super::domain::Domain;
use super::ground::{Above, Ground, Seen, areas, floor};
use super::overlay::Overlay;
use super::stretch::Frame;
use super::walk::walk;
use crate::mesh::metric;
use crate::solve::dirichlet::{Block, Metrics, Rest};
use glam::DVec2;

/// The moving mesh and what lies below it.
pub struct Smoother<'a> {
    pub(super) moving: &'a mut Domain,
    below: Below<'a>,
    rest: Vec<Rest>,
    /// Area of every triangle of the moving mesh in space.
    areas: Vec<f64>,
    /// No area below this one has a say.
    floor: f64,
    /// For every triangle that has a say what it saw, and where it was then.
    model: Vec<Option<(Seen, [DVec2; 3])>>,
    /// Where all vertices were then.
    start: Vec<DVec2>,
    /// Energy of all triangles when it was last looked at.
    before: f64,
}

/// Energy of a triangle and the area it counts for: their ratio is 1 for an isometry.
#[derive(Clone, Copy, Debug)]
pub(super) struct Weighed {
    pub energy: f64,
    pub weight: f64,
}

/// Halvings of the way back before nothing is left of the moves.
const HALVINGS: usize = 4;
/// Marks a triangle that has not been looked for yet.
const UNKNOWN: u32 = u32::MAX;

/// What lies below the moving mesh.
enum Below<'a> {
    /// The plane itself; the metrics of the triangles never change.
    Plane(Vec<Metrics>),
    /// Another mesh, with the fixed triangle where each moving one was last seen. The model keeps the change of the
    /// metrics' weights to first order: its value and gradient are the energy's.
    Mesh { ground: Ground<'a>, overlay: Overlay<'a>, seats: Vec<u32> },
    /// Another mesh seen at the middles of both meshes' triangles alone, with the triangles where these were last seen.
    Sampled { ground: Ground<'a>, down: Vec<u32>, up: Vec<u32> },
}

/// The energy of the map from a mesh to another one in the same domain: the mean area of both for an isometry.
pub fn energy(moving: &Domain, fixed: &Domain) -> f64 {
    let ground = Ground::new(fixed);
    let mut overlay = ground.overlay();
    let areas = areas(moving);
    let (floor, mut near, mut sum) = (floor(&areas), 0, 0.0);
    for (t, corners) in moving.triangles.iter().enumerate().filter(|&(t, _)| areas[t] > floor) {
        let above = Above::new(moving.triangle(t), moving.spatial(corners));
        let seen = ground.gather(&mut overlay, &above, near, false);
        near = seen.seat;
        sum += above.rest.energy(&seen.metrics, above.corners);
    }
    sum
}

impl<'a> Smoother<'a> {
    /// A mesh over another one: the energy is that of the composed map.
    pub fn new(moving: &'a mut Domain, fixed: &'a Domain) -> Self {
        let ground = Ground::new(fixed);
        let seats = vec![UNKNOWN; moving.triangles.len()];
        Self::over(moving, Below::Mesh { overlay: ground.overlay(), ground, seats })
    }

    /// A mesh over another one, seen at the middles of both meshes' triangles alone: cheaper, and near enough while much
    /// is left to do.
    pub fn sampled(moving: &'a mut Domain, fixed: &'a Domain) -> Self {
        let ground = Ground::new(fixed);
        let (down, up) = (vec![UNKNOWN; moving.triangles.len()], vec![UNKNOWN; fixed.triangles.len()]);
        Self::over(moving, Below::Sampled { ground, down, up })
    }

    /// A patch over the flat triangle of its frame, scaled to the patch's area: for embeddings of one mesh alone.
    pub fn flat(moving: &'a mut Domain, frame: &Frame) -> Self {
        let areas = areas(moving);
        let unit = (areas.iter().sum::<f64>() / frame.area()).sqrt();
        let derivative = [frame.first, frame.second].map(|d| (d * unit).extend(0.0));
        let weigh = |&area: &f64| {
            let mut metrics = Metrics::NONE;
            metrics.add(derivative, area);
            metrics
        };
        let metrics = areas.iter().map(weigh).collect();
        Self::over(moving, Below::Plane(metrics))
    }

    /// A mesh over the plane, where every triangle wants a shape: corners in a plane of its own, counter-clockwise, and
    /// how much of its area counts.
    pub fn shaped(moving: &'a mut Domain, shapes: &[[DVec2; 3]], weights: &[f64]) -> Self {
        let areas: Vec<f64> = shapes.iter().map(|&shape| metric::signed_area(shape)).collect();
        let metrics = areas.iter().zip(weights).map(|(area, weight)| Metrics::identity(area * weight)).collect();
        let rest = shapes.iter().map(|&shape| Rest::new(shape)).collect();
        Self::resting(moving, Below::Plane(metrics), rest, areas)
    }

    fn over(moving: &'a mut Domain, below: Below<'a>) -> Self {
        let rest = moving.triangles.iter().map(|t| Rest::new(metric::flatten(moving.spatial(t)))).collect();
        let areas = areas(moving);
        Self::resting(moving, below, rest, areas)
    }

    /// From the triangles at rest and their areas.
    fn resting(moving: &'a mut Domain, below: Below<'a>, rest: Vec<Rest>, areas: Vec<f64>) -> Self {
        let start = moving.positions.clone();
        let floor = floor(&areas);
        let mut smoother = Smoother { moving, below, rest, floor, areas, model: Vec::new(), start, before: 0.0 };
        smoother.look();
        smoother
    }

    /// The moving mesh.
    pub fn moving(&self) -> &Domain {
        self.moving
    }

    /// A triangle at rest and the metrics it saw, none if it has no say.
    pub fn seen(&self, t: usize) -> (&Rest, Metrics) {
        (&self.rest[t], self.model[t].as_ref().map_or(Metrics::NONE, |(seen, _)| seen.metrics))
    }

    /// Moves all vertices; where that would turn a triangle over, as moves made in less precision may, its corners stay
    /// where they were last looked at.
    pub fn adopt(&mut self, positions: Vec<DVec2>) {
        self.moving.positions = positions;
        loop {
            let folded = |&t: &usize| metric::signed_area(self.moving.triangle(t)) <= 0.0;
            let back: Vec<usize> = (0..self.rest.len()).filter(folded).collect();
            let corners = back.iter().flat_map(|&t| self.moving.triangles[t]).map(|v| v as usize);
            let moved: Vec<usize> = corners.filter(|&v| self.moving.positions[v] != self.start[v]).collect();
            if moved.is_empty() {
                return;
            }
            moved.into_iter().for_each(|v| self.moving.positions[v] = self.start[v]);
        }
    }

    /// Makes the model of one triangle anew where its corners are now.
    pub(super) fn look_at(&mut self, t: usize) {
        let corners = self.moving.triangle(t);
        self.model[t] = self.see(t, t, true).map(|s| (s, corners));
    }

    /// Energy of a triangle and the area it counts for; none if it has no say.
    pub(super) fn exact_energy_of(&mut self, t: usize) -> Option<Weighed> {
        let metrics = self.see(t, t, false)?.metrics;
        Some(Weighed { energy: self.rest[t].energy(&metrics, self.moving.triangle(t)), weight: metrics.weight })
    }

    /// Makes the model of the energy where the vertices are now.
    pub fn look(&mut self) {
        self.start.clone_from(&self.moving.positions);
        self.model.clear();
        let sampled = self.sample();
        let mut sum = 0.0;
        for t in 0..self.rest.len() {
            let corners = self.moving.triangle(t);
            let seen = match &sampled {
                Some(metrics) => (self.areas[t] > self.floor).then(|| Seen::of(metrics[t])),
                None => self.see(t, t.saturating_sub(1), true),
            };
            sum += seen.as_ref().map_or(0.0, |s| self.rest[t].energy(&s.metrics, corners));
            self.model.push(seen.map(|s| (s, corners)));
        }
        self.before = sum;
    }

    /// Energy where it was last looked at: the mean area of both meshes for an isometry.
    pub fn energy(&self) -> f64 {
        self.before
    }

    /// Area of the moving mesh in space.
    pub fn area(&self) -> f64 {
        self.areas.iter().sum()
    }

    /// Looks again after moves and takes back as much as it must for the energy to fall. The model is then out of date.
    pub fn settle(&mut self) {
        for _ in 0..=HALVINGS {
            let after = self.exact_energy();
            if after < self.before {
                self.before = after;
                return;
            }
            for (p, q) in self.moving.positions.iter_mut().zip(&self.start) {
                *p = (*p + *q) * 0.5;
            }
        }
        self.moving.positions.clone_from(&self.start);
    }

    fn exact_energy(&mut self) -> f64 {
        let sampled = self.sample();
        let mut sum = 0.0;
        for t in 0..self.rest.len() {
            if self.areas[t] <= self.floor {
                continue;
            }
            let metrics = match &sampled {
                Some(metrics) => Some(metrics[t]),
                None => self.see(t, t, false).map(|seen| seen.metrics),
            };
            sum += metrics.map_or(0.0, |m| self.rest[t].energy(&m, self.moving.triangle(t)));
        }
        sum
    }

    /// The model's energy of a triangle where its corners are now; none if it has no say.
    pub(super) fn model_energy(&self, t: usize) -> Option<f64> {
        let (seen, then) = self.model[t].as_ref()?;
        let now = self.moving.triangle(t);
        let linear: f64 = (0..3).map(|i| seen.slope[i].dot(now[i] - then[i])).sum();
        Some(self.rest[t].energy(&seen.metrics, now) + linear)
    }

    /// Derivatives of the model's energy of a triangle; none if it has no say.
    pub(super) fn model_block(&self, t: usize) -> Option<Block> {
        let (seen, _) = self.model[t].as_ref()?;
        let mut block = self.rest[t].block(&seen.metrics, self.moving.triangle(t));
        (0..3).for_each(|i| block.gradient[i] += seen.slope[i]);
        Some(block)
    }

    /// What a triangle sees below it; one not looked for yet is looked for where triangle `like` was found.
    fn see(&mut self, t: usize, like: usize, slopes: bool) -> Option<Seen> {
        if self.areas[t] <= self.floor {
            return None;
        }
        match &mut self.below {
            Below::Plane(metrics) => Some(Seen::of(metrics[t])),
            Below::Mesh { ground, overlay, seats } => {
                let above = Above { corners: self.moving.triangle(t), rest: self.rest[t], area: self.areas[t] };
                let near = [seats[t], seats[like], 0].into_iter().find(|&s| s != UNKNOWN).unwrap_or(0);
                let seen = ground.gather(overlay, &above, near, slopes);
                seats[t] = seen.seat;
                Some(seen)
            }
            Below::Sampled { .. } => None,
        }
    }

    /// What all triangles see at the middles of triangles, each weighed with half its area in space; none if that is not
    /// how this one looks.
    fn sample(&mut self) -> Option<Vec<Metrics>> {
        let Below::Sampled { ground, down, up } = &mut self.below else { return None };
        let mut metrics = vec![Metrics::NONE; self.rest.len()];
        let mut near = 0;
        for (t, metrics) in metrics.iter_mut().enumerate() {
            let start = if down[t] == UNKNOWN { near } else { down[t] };
            near = walk(ground.domain(), start, middle(self.moving.triangle(t))).triangle;
            down[t] = near;
            metrics.add_weighted(ground.metric(near), 0.5 * self.areas[t]);
        }
        near = 0;
        for (f, up) in (0u32..).zip(up.iter_mut()) {
            let start = if *up == UNKNOWN { near } else { *up };
            near = walk(self.moving, start, middle(ground.domain().triangle(f as usize))).triangle;
            *up = near;
            metrics[near as usize].add_weighted(ground.metric(f), ground.weight(f));
        }
        Some(metrics)
    }
}

fn middle([a, b, c]: [DVec2; 3]) -> DVec2 {
    (a + b + c) / 3.0
}

#[cfg(test)]
mod tests {
    use super::super::exact_sweep::sweep_exactly;
    use super::super::grid::{grid, swirl};
    use super::super::newton::newton;
    use super::*;

    #[test]
    fn an_isometry_has_its_area_as_energy() {
        let [coarse, fine] = [grid(3, |p| p), grid(7, |p| p)];
        assert!((energy(&coarse, &fine) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn sampled_at_middles_the_energy_is_nearly_the_same() {
        let [one, other] = [grid(12, swirl), grid(17, |p| p)];
        let [exact, sampled] = [energy(&one, &other), Smoother::sampled(&mut one.clone(), &other).energy()];
        assert!((sampled - exact).abs() < 0.02 * exact, "{sampled} for {exact}");
    }

    #[test]
    fn the_energy_is_the_same_whichever_mesh_moves() {
        let [one, other] = [grid(4, swirl), grid(7, |p| p)];
        let [forth, back] = [energy(&one, &other), energy(&other, &one)];
        assert!(forth > 1.01 && (forth - back).abs() < 1e-10, "{forth} {back}");
    }

    #[test]
    fn the_model_has_the_gradient_of_the_energy() {
        let (mut moving, fixed) = (grid(3, swirl), grid(5, |p| p));
        let v = (0..moving.free.len()).find(|&v| moving.free[v]).expect("a grid has inner vertices");
        let mut gradient = DVec2::ZERO;
        let smoother = Smoother::new(&mut moving, &fixed);
        for t in 0..smoother.moving.triangles.len() {
            let corners = smoother.moving.triangles[t];
            let block = smoother.model_block(t).expect("no triangle is negligible");
            (0..3).filter(|&i| corners[i] as usize == v).for_each(|i| gradient += block.gradient[i]);
        }
        let step = 1e-6;
        for axis in [DVec2::X, DVec2::Y] {
            let at = |by: f64| {
                let mut moved = moving.clone();
                moved.positions[v] += axis * by;
                energy(&moved, &fixed)
            };
            let measured = (at(step) - at(-step)) / (2.0 * step);
            assert!((measured - gradient.dot(axis)).abs() < 1e-6, "{measured} {gradient}");
        }
    }

    #[test]
    fn relaxed_exactly_a_swirl_unwinds_and_the_energy_never_rises() {
        let (mut moving, fixed) = (grid(6, swirl), grid(6, |p| p));
        let mut last = energy(&moving, &fixed);
        let first = last;
        for _ in 0..12 {
            let mut smoother = Smoother::new(&mut moving, &fixed);
            sweep_exactly(&mut smoother);
            smoother.look();
            newton(&mut smoother);
            smoother.settle();
            let now = smoother.energy();
            assert!(now <= last + 1e-12, "{now} after {last}");
            last = now;
        }
        assert!(last - 1.0 < 0.02 * (first - 1.0), "{first} to {last}");
    }
}
