//! Vertices moved so that the compatible meshes get better: what users see of a map.
//!
//! A compatible mesh samples the map at the vertices alone. Where a triangle spans a fold of the other surface its image
//! may be turned over although the map is not, and even where it is not turned its shape is not what the map's energy
//! says. Here the energy of the sampled triangles of both meshes falls: a vertex takes its own image along, and the
//! images of the other mesh's vertices that lie in the triangles around it. A triangle that is turned over costs as much as
//! many that are stretched, and more the farther it is turned; one whose image is much larger costs more than its energy, for
//! it hides how the other surface really looks. The map stays a homeomorphism.

use super::domain::{Domain, Fans};
use super::samples::{Sample, Samples};
use super::walk::{Spot, walk};
use crate::mesh::metric;
use glam::{DMat2, DVec2, DVec3};
use std::f64::consts::TAU;

/// A step goes at most this share of the way to the first triangle that collapses.
const SAFE_SHARE: f64 = 0.8;
/// Halvings of a step before the vertex stays.
const HALVINGS: usize = 3;
/// Directions in which new places are tried where triangles are turned over.
const DIRECTIONS: usize = 12;
/// How far, in mean distances to the neighbours.
const REACHES: [f64; 6] = [0.03, 0.1, 0.25, 0.5, 0.9, 1.5];
/// Triangles keep this share of the area in the plane that they would have if all around were even: those that arcs cut
/// off have next to no say, and would vanish.
const LEAST_LEFT: f64 = 0.05;
/// Least area of a triangle in the plane that is not less already: smaller ones get lost in rounding.
const LEAST_AREA: f64 = 1e-12;
/// A triangle is safe from turning over if the cosine of its angle against the surface is at least this.
const SAFE_COSINE: f64 = 0.05;

/// Where a vertex of the domain lies in the other mesh.
#[derive(Clone, Copy)]
struct Image {
    spot: Spot,
    sample: Sample,
}

impl Image {
    fn at(spot: Spot, domain: &Domain) -> Self {
        let [p, q, r] = domain.spatial(&domain.triangles[spot.triangle as usize]);
        let sample = Sample { point: spot.point(domain), normal: (q - p).cross(r - p).normalize_or_zero() };
        Image { spot, sample }
    }
}

/// The triangles around a vertex: the energy of all, more where they are turned over, and how many are.
#[derive(Clone, Copy)]
struct State {
    cost: f64,
    turned: usize,
}

struct Polisher<'a> {
    moving: &'a mut Domain,
    fixed: &'a Domain,
    fans: Fans,
    /// No triangle of the moving mesh gets smaller than this in the plane, doubled.
    least: Vec<f64>,
    /// Of the moving and of the fixed mesh.
    samples: [&'a Samples; 2],
    /// Of the moving mesh's vertices on the fixed one, and the other way round; none for vertices without triangles.
    images: [Vec<Option<Image>>; 2],
    /// For every triangle of the moving mesh the vertices of the fixed one in it.
    seated: Vec<Vec<u32>>,
    /// What one move concerns: vertices of the fixed mesh, and triangles of the fixed mesh.
    riders: Vec<u32>,
    ridden: Vec<u32>,
}

/// What polishing a domain brought.
#[derive(Clone, Debug, Default)]
pub struct Polished {
    /// So many fewer triangles are turned over.
    pub turned_back: isize,
    /// By how much the energy fell, what turned triangles cost included.
    pub gained: f64,
    /// Where the vertices of the moving and the fixed mesh lie now, if triangles depend on it.
    pub images: [Vec<Option<Sample>>; 2],
}

/// Visits every vertex of `moving` that may move once.
pub fn polish(moving: &mut Domain, fixed: &Domain, samples: [&Samples; 2]) -> Polished {
    let fans = moving.fans();
    let images = [locate(moving, fixed, samples[0]), locate(fixed, moving, samples[1])];
    let mut seated = vec![Vec::new(); moving.triangles.len()];
    for (y, image) in (0u32..).zip(&images[1]) {
        if let Some(image) = image {
            seated[image.spot.triangle as usize].push(y);
        }
    }
    let (riders, ridden) = (Vec::new(), Vec::new());
    let least = least_areas(moving, &fans);
    let mut polisher = Polisher { moving, fixed, fans, least, samples, images, seated, riders, ridden };
    let mut polished = Polished::default();
    for v in 0..polisher.moving.vertices.len() {
        if samples[0].free[v] {
            let (before, after) = polisher.improve(v);
            polished.gained += before.cost - after.cost;
            polished.turned_back += before.turned as isize - after.turned as isize;
        }
    }
    polished.images = polisher.images.map(|images| images.into_iter().map(|i| i.map(|i| i.sample)).collect());
    polished
}

/// No triangle gets smaller than this in the plane, doubled: a share of what its neighbourhood has for its area in space,
/// or what it has if that is less already.
fn least_areas(domain: &Domain, fans: &Fans) -> Vec<f64> {
    let planar: Vec<f64> = (0..domain.triangles.len()).map(|t| metric::signed_area(domain.triangle(t))).collect();
    let spatial: Vec<f64> = domain.triangles.iter().map(|t| metric::area(domain.spatial(t))).collect();
    let density = |v: u32| {
        let sum = |areas: &[f64]| fans.around(v as usize).iter().map(|&(t, _)| areas[t as usize]).sum::<f64>();
        sum(&planar) / sum(&spatial)
    };
    let density: Vec<f64> = (0..domain.vertices.len() as u32).map(density).collect();
    let one = |(t, corners): (usize, &[u32; 3])| {
        let usual = corners.iter().map(|&v| density[v as usize]).sum::<f64>() / 3.0 * spatial[t];
        2.0 * (LEAST_LEFT * usual).max(LEAST_AREA).min(planar[t] * (1.0 - 1e-9))
    };
    domain.triangles.iter().enumerate().map(one).collect()
}

/// The images of the vertices that carry samples.
fn locate(domain: &Domain, on: &Domain, samples: &Samples) -> Vec<Option<Image>> {
    let mut near = 0;
    let one = |v: usize| {
        (!samples.around[v].is_empty()).then(|| {
            let spot = walk(on, near, domain.positions[v]);
            near = spot.triangle;
            Image::at(spot, on)
        })
    };
    (0..domain.vertices.len()).map(one).collect()
}

impl Polisher<'_> {
    /// Moves `v` where that helps; returns the state around it before and after.
    fn improve(&mut self, v: usize) -> (State, State) {
        self.gather(v);
        let before = self.state(v);
        let mut best = before;
        let from = self.moving.positions[v];
        let mut place = from;
        if let Some(step) = self.step(v) {
            let mut share = (SAFE_SHARE * self.first_collapse(v, step)).min(1.0);
            for _ in 0..=HALVINGS {
                self.put(v, from + step * share);
                let state = self.state(v);
                if state.cost < best.cost {
                    (best, place) = (state, self.moving.positions[v]);
                    break;
                }
                share *= 0.5;
            }
        }
        if best.turned > 0 {
            (best, place) = self.search(v, from, (best, place));
        }
        if self.moving.positions[v] != place {
            self.put(v, place);
        }
        self.seat(v);
        (before, best)
    }

    /// Tries places all around for one with fewer triangles turned over.
    fn search(&mut self, v: usize, from: DVec2, found: (State, DVec2)) -> (State, DVec2) {
        let ring: Vec<([DVec2; 2], f64)> =
            self.fans.around(v).iter().map(|&(t, i)| (self.opposite(t, i), self.least[t as usize])).collect();
        let reach = ring.iter().map(|([a, _], _)| a.distance(from)).sum::<f64>() / ring.len() as f64;
        let keeps = |p: DVec2| ring.iter().all(|&([a, b], least)| (a - p).perp_dot(b - p) > least);
        let (mut best, mut place) = found;
        for k in 0..DIRECTIONS * REACHES.len() {
            let turn = DVec2::from_angle(TAU * (k % DIRECTIONS) as f64 / DIRECTIONS as f64);
            let p = from + turn * (reach * REACHES[k / DIRECTIONS]);
            if keeps(p) {
                self.put(v, p);
                let state = self.state(v);
                if state.cost < best.cost {
                    (best, place) = (state, p);
                }
            }
        }
        (best, place)
    }

    fn opposite(&self, t: u32, i: u8) -> [DVec2; 2] {
        let corners = self.moving.triangles[t as usize];
        [1, 2].map(|k| self.moving.positions[corners[(i as usize + k) % 3] as usize])
    }

    /// Notes what moving `v` concerns.
    fn gather(&mut self, v: usize) {
        self.riders.clear();
        self.ridden.clear();
        for &(t, _) in self.fans.around(v) {
            self.riders.extend(&self.seated[t as usize]);
        }
        for &y in &self.riders {
            self.ridden.extend(&self.samples[1].around[y as usize]);
        }
        self.ridden.sort_unstable();
        self.ridden.dedup();
    }

    /// Puts `v` to a place, and its image and those of its riders where they then are.
    fn put(&mut self, v: usize, p: DVec2) {
        self.moving.positions[v] = p;
        let near = self.images[0][v].map_or(0, |i| i.spot.triangle);
        self.images[0][v] = Some(Image::at(walk(self.fixed, near, p), self.fixed));
        for k in 0..self.riders.len() {
            let y = self.riders[k] as usize;
            let spot = self.spot_around(v, self.fixed.positions[y]);
            self.images[1][y] = Some(Image::at(spot, self.moving));
        }
    }

    /// The spot of a point in the triangles around `v`.
    fn spot_around(&self, v: usize, p: DVec2) -> Spot {
        let mut best = (f64::NEG_INFINITY, Spot::default());
        for &(t, _) in self.fans.around(v) {
            let [a, b, c] = self.moving.triangle(t as usize);
            let areas = [(b - p).perp_dot(c - p), (c - p).perp_dot(a - p), (a - p).perp_dot(b - p)];
            let sum: f64 = areas.iter().sum();
            let least = areas.iter().copied().fold(f64::INFINITY, f64::min) / sum;
            if least > best.0 {
                let inside = areas.map(|x| x.max(0.0));
                let sum: f64 = inside.iter().sum();
                best = (least, Spot { triangle: t, weights: inside.map(|x| x / sum) });
            }
        }
        best.1
    }

    /// Sorts the riders of `v` into its triangles anew.
    fn seat(&mut self, v: usize) {
        for &(t, _) in self.fans.around(v) {
            self.seated[t as usize].clear();
        }
        for &y in &self.riders {
            if let Some(image) = self.images[1][y as usize] {
                self.seated[image.spot.triangle as usize].push(y);
            }
        }
    }

    fn state(&self, v: usize) -> State {
        let mut state = State { cost: 0.0, turned: 0 };
        for (side, f) in self.concerned(v) {
            let Some(image) = self.face_image(side, f) else { continue };
            if (f as usize) < self.samples[side].whole {
                let cosine = facing(&image);
                state.cost += self.samples[side].dread * (SAFE_COSINE - cosine).max(0.0);
                state.turned += usize::from(cosine < 0.0);
            }
            let area = self.samples[side].area[f as usize];
            if area > 0.0 {
                let flat = metric::flatten(image.map(|i| i.point));
                state.cost += self.samples[side].rest[f as usize].cost(area, self.samples[side].dislike, flat);
            }
        }
        state
    }

    /// The triangles, by mesh, whose images move with `v`.
    fn concerned(&self, v: usize) -> impl Iterator<Item = (usize, u32)> {
        let own = self.samples[0].around[v].iter().map(|&f| (0, f));
        own.chain(self.ridden.iter().map(|&f| (1, f)))
    }

    fn face_image(&self, side: usize, f: u32) -> Option<[Sample; 3]> {
        let images = &self.images[side];
        let image = |v: u32| match images.get(v as usize) {
            Some(image) => image.map(|i| i.sample),
            None => self.samples[side].outside.get(v as usize - images.len()).copied(),
        };
        let [a, b, c] = self.samples[side].faces[f as usize].map(image);
        Some([a?, b?, c?])
    }

    /// The Newton step of the energy around `v`, within the triangles where the images lie now.
    fn step(&self, v: usize) -> Option<DVec2> {
        let (mut gradient, mut hessian) = (DVec2::ZERO, DMat2::ZERO);
        for (side, f) in self.concerned(v) {
            let area = self.samples[side].area[f as usize];
            let Some(image) = self.face_image(side, f).filter(|_| area > 0.0) else { continue };
            let points = image.map(|i| i.point);
            let flat = metric::flatten(points);
            let block = self.samples[side].rest[f as usize].cost_block(area, self.samples[side].dislike, flat);
            let along = (points[1] - points[0]).normalize_or_zero();
            let normal = (points[1] - points[0]).cross(points[2] - points[0]).normalize_or_zero();
            let axes = [along, normal.cross(along)];
            let corners = self.samples[side].faces[f as usize];
            let moves: [Option<DMat2>; 3] = std::array::from_fn(|i| {
                let [du, dv] = self.derivative(side, corners[i], v)?;
                Some(DMat2::from_cols(
                    DVec2::new(axes[0].dot(du), axes[1].dot(du)),
                    DVec2::new(axes[0].dot(dv), axes[1].dot(dv)),
                ))
            });
            for i in 0..3 {
                let Some(mine) = moves[i] else { continue };
                gradient += mine.transpose() * block.gradient[i];
                for j in 0..3 {
                    if let Some(other) = moves[j] {
                        hessian += mine.transpose() * block.hessian[i][j] * other;
                    }
                }
            }
        }
        let step = -(hessian.inverse() * gradient);
        step.is_finite().then_some(step)
    }

    /// Derivative of a vertex's image by the position of `v`; none if it does not move with it.
    fn derivative(&self, side: usize, w: u32, v: usize) -> Option<[DVec3; 2]> {
        if side == 0 {
            return (w as usize == v).then(|| self.images[0][v].map(|i| i.spot.derivative(self.fixed)))?;
        }
        let spot = (*self.images[1].get(w as usize)?)?.spot;
        let corner = self.moving.triangles[spot.triangle as usize].iter().position(|&u| u as usize == v)?;
        Some(spot.derivative(self.moving).map(|d| d * -spot.weights[corner]))
    }

    /// The share of the step at which the first triangle around `v` collapses.
    fn first_collapse(&self, v: usize, step: DVec2) -> f64 {
        let p = self.moving.positions[v];
        let one = |&(t, i): &(u32, u8)| {
            let [b, c] = self.opposite(t, i);
            let (area, loss) = ((b - p).perp_dot(c - p) - self.least[t as usize], step.perp_dot(c - b));
            if loss > 0.0 { area / loss } else { f64::INFINITY }
        };
        self.fans.around(v).iter().map(one).fold(f64::INFINITY, f64::min)
    }
}

/// Cosine of the angle between the image of a triangle and the surface at its corners.
fn facing([a, b, c]: &[Sample; 3]) -> f64 {
    let normal = (b.point - a.point).cross(c.point - a.point).normalize_or_zero();
    normal.dot((a.normal + b.normal + c.normal).normalize_or_zero())
}

#[cfg(test)]
mod tests {
    use super::super::grid::{grid, swirl};
    use super::super::samples::Price;
    use super::*;
    use crate::solve::dirichlet::Metrics;

    fn samples(domain: &Domain) -> Samples {
        Samples::new(
            domain,
            domain.triangles.clone(),
            &[],
            &[],
            domain.free.clone(),
            Price { dread: 1000.0, dislike: 0.03 },
        )
    }

    /// Energy and number of turned triangles of the images of `mesh`.
    fn measure(mesh: &Domain, samples: &Samples, images: &[Option<Sample>]) -> (f64, usize) {
        let image = |v: u32| images[v as usize].expect("every vertex has triangles");
        let mut sums = (0.0, 0);
        for (f, corners) in mesh.triangles.iter().enumerate() {
            let image = corners.map(image);
            sums.0 +=
                samples.rest[f].energy(&Metrics::identity(samples.area[f]), metric::flatten(image.map(|s| s.point)));
            sums.1 += usize::from(facing(&image) < 0.0);
        }
        sums
    }

    fn located(mesh: &Domain, on: &Domain, samples: &Samples) -> Vec<Option<Sample>> {
        locate(mesh, on, samples).into_iter().map(|image| image.map(|i| i.sample)).collect()
    }

    #[test]
    fn a_swirl_unwinds_and_nothing_folds() {
        let (mut moving, fixed) = (grid(7, swirl), grid(6, |p| p));
        let [of_moving, of_fixed] = [samples(&moving), samples(&fixed)];
        let before = measure(&moving, &of_moving, &located(&moving, &fixed, &of_moving)).0
            + measure(&fixed, &of_fixed, &located(&fixed, &moving, &of_fixed)).0;
        for _ in 0..10 {
            polish(&mut moving, &fixed, [&of_moving, &of_fixed]);
        }
        let images = [located(&moving, &fixed, &of_moving), located(&fixed, &moving, &of_fixed)];
        let after = measure(&moving, &of_moving, &images[0]).0 + measure(&fixed, &of_fixed, &images[1]).0;
        assert!(after - 2.0 < 0.05 * (before - 2.0), "{before} to {after}");
        assert!((0..moving.triangles.len()).all(|t| metric::signed_area(moving.triangle(t)) > 0.0));
    }

    #[test]
    fn what_is_told_of_the_images_is_where_they_are() {
        let (mut moving, fixed) = (grid(7, swirl), grid(6, |p| p));
        let [of_moving, of_fixed] = [samples(&moving), samples(&fixed)];
        let told = polish(&mut moving, &fixed, [&of_moving, &of_fixed]).images;
        let fresh = [located(&moving, &fixed, &of_moving), located(&fixed, &moving, &of_fixed)];
        for (told, fresh) in told.iter().flatten().zip(fresh.iter().flatten()) {
            let [told, fresh] = [told, fresh].map(|s| s.expect("every vertex has triangles").point);
            assert!(told.distance(fresh) < 1e-12, "{told} {fresh}");
        }
    }

    /// ```text
    ///    /\    one triangle of the moving mesh reaches over the ridge of the fixed one, a vertex at its steep side
    /// __/  \__
    /// ```
    #[test]
    fn triangles_that_a_ridge_turned_over_are_turned_back() {
        let mut fixed = grid(12, |p| p);
        for p in &mut fixed.points {
            p.z = 2.0 * (0.25 - (p.x - 0.5).abs()).max(0.0);
            p.x += 1.2 * p.z;
        }
        let mut moving = grid(5, swirl);
        let [of_moving, of_fixed] = [samples(&moving), samples(&fixed)];
        let turned = |moving: &Domain| {
            measure(moving, &of_moving, &located(moving, &fixed, &of_moving)).1
                + measure(&fixed, &of_fixed, &located(&fixed, moving, &of_fixed)).1
        };
        let before = turned(&moving);
        let mut turned_back = 0;
        for _ in 0..4 {
            turned_back += polish(&mut moving, &fixed, [&of_moving, &of_fixed]).turned_back;
        }
        let after = turned(&moving);
        assert!(before > 0 && after < before, "{before} to {after}");
        assert_eq!(turned_back, before as isize - after as isize);
    }
}
