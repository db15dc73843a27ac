//! Relaxation of many patches at once, without read-back between sweeps.
//!
//! ```text
//! upload once: triangles, rings, weights, surface          run(sweeps), each sweep:
//!                                                             stretch -> vertex_stretch -> relax, colour by colour
//! read: positions, and the stretch of the map plane -> surface at them
//! ```
//!
//! Patches share no vertex, so all of them form one graph, and one dispatch per colour serves them all.

use std::ops::Range;

use glam::{DVec2, DVec3};

use crate::error::Result;
use crate::gpu::{Compute, GpuBuffer, GpuDevice, Launch};
use crate::solve::coloring::{self, Coloring};

use super::normalise::Normalised;
use super::relax::{self, RelaxBuffers};
use super::rings::{Lists, Rings};
use super::stretch::{self, Stretch};
use super::{Lanes, check_len, vertex_stretch};

/// What a [`RelaxSession`] works on: the patches of any number of meshes, one after the other.
#[derive(Clone, Copy, Debug)]
pub struct RelaxInput<'a> {
    /// Triangles of all patches, counter-clockwise in the plane.
    pub triangles: &'a [[u32; 3]],
    /// Rings of the vertices that may move; all others are fixed.
    pub rings: &'a Rings,
    /// Positive weights, parallel to `rings.lists().items`.
    pub weights: &'a [f32],
    /// Where the vertices lie on their surface, at any scale.
    pub surface: &'a [DVec3],
    /// Where the vertices lie in the plane, patches of about unit size: the embedding to start from.
    pub plane: &'a [DVec2],
}

/// [`RelaxSession::settle`] goes on while a batch of sweeps lowers a patch's energy by more than this share; a smaller
/// one costs sweeps that no longer show in a map's distortion.
pub const SETTLED: f64 = 1e-3;

/// How [`RelaxSession::run`] proceeds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RelaxOptions {
    /// Number of sweeps; 0 does nothing.
    pub sweeps: u32,
    /// Length of the first step tried, in units of the way to the weighted mean: 1 (the default) is Gauss-Seidel. More
    /// is faster where it settles at all: up to 1.2 with `power` at most 2.
    pub step: f32,
    /// How strongly stretch drives the weights, see [`vertex_stretch`]: 1 is the published `w / sigma` without
    /// accumulation, 3 (the default, and the most) ends lowest on unevenly stretched patches.
    pub power: u32,
}

impl Default for RelaxOptions {
    fn default() -> Self {
        RelaxOptions { sweeps: 16, step: 1.0, power: 3 }
    }
}

/// The state of a session after some sweeps.
#[derive(Clone, Debug, PartialEq)]
pub struct RelaxResult {
    /// Positions in the plane, exactly representable in f32.
    pub plane: Vec<DVec2>,
    /// Stretch of the map from these positions to the surface, per triangle; see [`stretch::energy`].
    pub stretches: Vec<Stretch>,
}

/// Patches on their device, ready for sweeps.
pub struct RelaxSession<'d> {
    backend: Backend<'d>,
    triangles: Vec<[u32; 3]>,
    normalised: Normalised,
}

enum Backend<'d> {
    Cpu(Box<CpuState>),
    Gpu(Box<GpuState<'d>>),
}

impl<'d> RelaxSession<'d> {
    /// Uploads the patches.
    ///
    /// Positions are rounded to f32. Where that turns a triangle over, relaxation may or may not set it right again;
    /// where it does not, every later state is as valid as the rounded start, exactly.
    ///
    /// Fails when the arrays do not fit together, or on a device error.
    pub fn new(compute: &'d Compute, input: &RelaxInput<'_>) -> Result<Self> {
        let plane: Vec<Lanes> = input.plane.iter().map(|p| [p.x as f32, p.y as f32, 0.0, 0.0]).collect();
        relax::check_lengths(input.rings, input.weights, &plane)?;
        check_len("surface positions", input.surface.len(), plane.len())?;
        let incident = Lists::incident(plane.len(), input.triangles)?;
        let coloring = coloring::color(plane.len(), |v| input.rings.of(v));
        let normalised = Normalised::new(input.triangles, input.surface, input.plane);
        let patches = Patches { input, surface: &normalised.surface, plane, incident, coloring };
        let backend = match compute {
            Compute::Cpu => Backend::Cpu(Box::new(CpuState::new(patches))),
            Compute::Gpu(gpu) => Backend::Gpu(Box::new(GpuState::new(gpu, patches)?)),
        };
        Ok(RelaxSession { backend, triangles: input.triangles.to_vec(), normalised })
    }

    /// Runs sweeps; on a device they are only submitted, [`RelaxSession::read`] waits for them.
    pub fn run(&mut self, options: &RelaxOptions) -> Result<()> {
        vertex_stretch::check_power(options.power)?;
        match &mut self.backend {
            Backend::Cpu(state) => state.run(&self.triangles, &self.normalised.surface, options),
            Backend::Gpu(state) => state.run(options)?,
        }
        Ok(())
    }

    /// Runs batches of `options.sweeps` until every patch has settled, and returns the best state of each.
    ///
    /// `patches` are the patches' ranges of triangles. A patch has settled when a batch lowers its energy by less than
    /// [`SETTLED`]; from then on it keeps its state, whatever the others need. At most `batches` are run. States with a
    /// triangle turned over count only where nothing better came.
    pub fn settle(&mut self, patches: &[Range<usize>], options: &RelaxOptions, batches: u32) -> Result<RelaxResult> {
        let mut best = self.read()?;
        let mut energies: Vec<f64> = patches.iter().map(|patch| self.energy_of(&best, patch)).collect();
        let mut open: Vec<usize> = (0..patches.len()).collect();
        for _ in 0..batches {
            if open.is_empty() {
                break;
            }
            self.run(options)?;
            let now = self.read()?;
            open.retain(|&i| {
                let (energy, before) = (self.energy_of(&now, &patches[i]), energies[i]);
                if energy < before {
                    energies[i] = energy;
                    self.copy_patch(&now, &mut best, patches[i].clone());
                }
                energy.is_infinite() || energy < before * (1.0 - SETTLED)
            });
        }
        Ok(best)
    }

    /// The energy of one patch, infinite when a triangle is not counter-clockwise.
    fn energy_of(&self, state: &RelaxResult, patch: &Range<usize>) -> f64 {
        let at = |v: u32| robust::Coord { x: state.plane[v as usize].x, y: state.plane[v as usize].y };
        let upright = |&[a, b, c]: &[u32; 3]| robust::orient2d(at(a), at(b), at(c)) > 0.0;
        if self.triangles[patch.clone()].iter().all(upright) {
            stretch::energy(&state.stretches[patch.clone()])
        } else {
            f64::INFINITY
        }
    }

    fn copy_patch(&self, from: &RelaxResult, to: &mut RelaxResult, patch: Range<usize>) {
        to.stretches[patch.clone()].copy_from_slice(&from.stretches[patch.clone()]);
        for &v in self.triangles[patch].as_flattened() {
            to.plane[v as usize] = from.plane[v as usize];
        }
    }

    /// The positions so far and their stretch.
    pub fn read(&self) -> Result<RelaxResult> {
        let (positions, stretches) = match &self.backend {
            Backend::Cpu(state) => {
                let mut stretches = bytemuck::zeroed_vec(self.triangles.len());
                measure(&self.triangles, &state.positions, &self.normalised.surface, &mut stretches);
                (state.positions.clone(), stretches)
            }
            Backend::Gpu(state) => state.read()?,
        };
        let plane = positions.iter().map(|p| DVec2::new(p[0].into(), p[1].into())).collect();
        Ok(RelaxResult { plane, stretches: self.normalised.undo(&stretches) })
    }
}

/// The checked input in the kernels' formats.
struct Patches<'a> {
    input: &'a RelaxInput<'a>,
    surface: &'a [Lanes],
    plane: Vec<Lanes>,
    incident: Lists,
    coloring: Coloring,
}

struct CpuState {
    rings: Rings,
    weights: Vec<f32>,
    incident: Lists,
    coloring: Coloring,
    positions: Vec<Lanes>,
    stretches: Vec<Stretch>,
    sigma: Vec<f32>,
}

impl CpuState {
    fn new(patches: Patches<'_>) -> Self {
        CpuState {
            rings: patches.input.rings.clone(),
            weights: patches.input.weights.to_vec(),
            incident: patches.incident,
            coloring: patches.coloring,
            stretches: bytemuck::zeroed_vec(patches.input.triangles.len()),
            sigma: vec![1.0; patches.plane.len()],
            positions: patches.plane,
        }
    }

    fn run(&mut self, triangles: &[[u32; 3]], surface: &[Lanes], options: &RelaxOptions) {
        for _ in 0..options.sweeps {
            measure(triangles, &self.positions, surface, &mut self.stretches);
            self.sigma = vertex_stretch::reference(&self.incident, &self.stretches, &self.sigma, options.power);
            for c in 0..self.coloring.colors() {
                let vertices = self.coloring.class(c);
                let positions = &mut self.positions;
                relax::reference(vertices, &self.rings, &self.weights, &self.sigma, positions, options.step);
            }
        }
    }
}

/// The stretch of triangles between places in the plane and on the surface.
fn measure(triangles: &[[u32; 3]], plane: &[Lanes], surface: &[Lanes], stretches: &mut [Stretch]) {
    stretch::reference(triangles, plane, surface, stretches).expect("the lists of incident triangles have them all");
}

struct GpuState<'d> {
    gpu: &'d GpuDevice,
    coloring: Coloring,
    incident_starts: GpuBuffer<u32>,
    incident: GpuBuffer<u32>,
    stretches: GpuBuffer<Stretch>,
    buffers: RelaxBuffers,
    measure: Launch,
}

impl<'d> GpuState<'d> {
    fn new(gpu: &'d GpuDevice, patches: Patches<'_>) -> Result<Self> {
        let lists = patches.input.rings.lists();
        let buffers = RelaxBuffers {
            vertices: gpu.upload("vertices", &patches.coloring.vertices)?,
            ring_starts: gpu.upload("ring_starts", &lists.starts)?,
            rings: gpu.upload("rings", &lists.items)?,
            weights: gpu.upload("weights", patches.input.weights)?,
            sigma: gpu.upload("sigma", &vec![1.0; patches.plane.len()])?,
            positions: gpu.upload("positions", &patches.plane)?,
        };
        let triangles = gpu.upload("triangles", patches.input.triangles)?;
        let surface = gpu.upload("surface", patches.surface)?;
        let stretches = gpu.allocate("stretches", triangles.len())?;
        Ok(GpuState {
            gpu,
            incident_starts: gpu.upload("starts", &patches.incident.starts)?,
            incident: gpu.upload("incident", &patches.incident.items)?,
            measure: stretch::launch(gpu, &triangles, &buffers.positions, &surface, &stretches),
            coloring: patches.coloring,
            stretches,
            buffers,
        })
    }

    fn run(&mut self, options: &RelaxOptions) -> Result<()> {
        let (starts, incident) = (&self.incident_starts, &self.incident);
        let sigma = &self.buffers.sigma;
        let average = vertex_stretch::launch(self.gpu, options.power, starts, incident, &self.stretches, sigma);
        let relax = |c| relax::launch(self.gpu, self.coloring.range(c), options.step, &self.buffers);
        let colors: Vec<Launch> = (0..self.coloring.colors()).map(relax).collect();
        for _ in 0..options.sweeps {
            self.gpu.submit([&self.measure, &average].into_iter().chain(&colors))?;
        }
        Ok(())
    }

    fn read(&self) -> Result<(Vec<Lanes>, Vec<Stretch>)> {
        self.gpu.submit([&self.measure])?;
        Ok((self.gpu.download(&self.buffers.positions)?, self.gpu.download(&self.stretches)?))
    }
}
