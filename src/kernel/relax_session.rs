//! Relaxation of many patches at once, without read-back between sweeps.
//!
//! ```text
//! upload once: triangles, rings, weights, surface          run(sweeps), each sweep:
//!                                                             stretch -> vertex_stretch -> relax, colour by colour
//! read: positions, and the stretch of the map plane -> surface at them
//! ```
//!
//! Patches share no vertex, so all of them form one graph, and one dispatch per colour serves them all.

use glam::{DVec2, DVec3};

use crate::error::Result;
use crate::gpu::{Compute, GpuBuffer, GpuDevice, Launch};
use crate::solve::coloring::{self, Coloring};

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
    /// Where the vertices lie on their surface, edge lengths within `1e-12..1e12`.
    pub surface: &'a [DVec3],
    /// Where the vertices lie in the plane, patches of about unit size: the embedding to start from.
    pub plane: &'a [DVec2],
}

/// How [`RelaxSession::run`] proceeds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RelaxOptions {
    /// Number of sweeps; 0 does nothing.
    pub sweeps: u32,
    /// Length of the first step tried, in units of the way to the weighted mean: 1 (the default) is Gauss-Seidel,
    /// values up to 2 over-relax.
    pub step: f32,
}

impl Default for RelaxOptions {
    fn default() -> Self {
        RelaxOptions { sweeps: 16, step: 1.0 }
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
pub struct RelaxSession<'d>(Backend<'d>);

enum Backend<'d> {
    Cpu(CpuState),
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
        let patches = Patches { input, surface: centred(input.surface), plane, incident, coloring };
        Ok(RelaxSession(match compute {
            Compute::Cpu => Backend::Cpu(CpuState::new(patches)),
            Compute::Gpu(gpu) => Backend::Gpu(Box::new(GpuState::new(gpu, patches)?)),
        }))
    }

    /// Runs sweeps; on a device they are only submitted, [`RelaxSession::read`] waits for them.
    pub fn run(&mut self, options: &RelaxOptions) -> Result<()> {
        match &mut self.0 {
            Backend::Cpu(state) => state.run(options),
            Backend::Gpu(state) => state.run(options)?,
        }
        Ok(())
    }

    /// The positions so far and their stretch.
    pub fn read(&self) -> Result<RelaxResult> {
        let (positions, stretches) = match &self.0 {
            Backend::Cpu(state) => (state.positions.clone(), state.stretches()),
            Backend::Gpu(state) => state.read()?,
        };
        let plane = positions.iter().map(|p| DVec2::new(p[0].into(), p[1].into())).collect();
        Ok(RelaxResult { plane, stretches })
    }
}

/// Stretch does not depend on where the surface lies, but f32 resolves it best around the origin.
fn centred(surface: &[DVec3]) -> Vec<Lanes> {
    let low = surface.iter().copied().reduce(DVec3::min).unwrap_or_default();
    let high = surface.iter().copied().reduce(DVec3::max).unwrap_or_default();
    let centre = (low + high) * 0.5;
    surface.iter().map(|&p| (p - centre).as_vec3().extend(0.0).to_array()).collect()
}

/// The checked input in the kernels' formats.
struct Patches<'a> {
    input: &'a RelaxInput<'a>,
    surface: Vec<Lanes>,
    plane: Vec<Lanes>,
    incident: Lists,
    coloring: Coloring,
}

struct CpuState {
    triangles: Vec<[u32; 3]>,
    rings: Rings,
    weights: Vec<f32>,
    surface: Vec<Lanes>,
    incident: Lists,
    coloring: Coloring,
    positions: Vec<Lanes>,
}

impl CpuState {
    fn new(patches: Patches<'_>) -> Self {
        CpuState {
            triangles: patches.input.triangles.to_vec(),
            rings: patches.input.rings.clone(),
            weights: patches.input.weights.to_vec(),
            surface: patches.surface,
            incident: patches.incident,
            coloring: patches.coloring,
            positions: patches.plane,
        }
    }

    fn stretches(&self) -> Vec<Stretch> {
        stretch::reference(&self.triangles, &self.positions, &self.surface)
    }

    fn run(&mut self, options: &RelaxOptions) {
        for _ in 0..options.sweeps {
            let sigma = vertex_stretch::reference(&self.incident, &self.stretches());
            for c in 0..self.coloring.colors() {
                let vertices = self.coloring.class(c);
                relax::reference(vertices, &self.rings, &self.weights, &sigma, &mut self.positions, options.step);
            }
        }
    }
}

struct GpuState<'d> {
    gpu: &'d GpuDevice,
    coloring: Coloring,
    stretches: GpuBuffer<Stretch>,
    buffers: RelaxBuffers,
    measure: Launch,
    average: Launch,
    /// The colours' launches and the step they were made for.
    relax: Option<(f32, Vec<Launch>)>,
}

impl<'d> GpuState<'d> {
    fn new(gpu: &'d GpuDevice, patches: Patches<'_>) -> Result<Self> {
        let lists = patches.input.rings.lists();
        let buffers = RelaxBuffers {
            vertices: gpu.upload("vertices", &patches.coloring.vertices)?,
            ring_starts: gpu.upload("ring_starts", &lists.starts)?,
            rings: gpu.upload("rings", &lists.items)?,
            weights: gpu.upload("weights", patches.input.weights)?,
            sigma: gpu.allocate("sigma", patches.plane.len())?,
            positions: gpu.upload("positions", &patches.plane)?,
        };
        let triangles = gpu.upload("triangles", patches.input.triangles)?;
        let surface = gpu.upload("surface", &patches.surface)?;
        let incident_starts = gpu.upload("starts", &patches.incident.starts)?;
        let incident = gpu.upload("incident", &patches.incident.items)?;
        let stretches = gpu.allocate("stretches", triangles.len())?;
        let measure = stretch::launch(gpu, &triangles, &buffers.positions, &surface, &stretches);
        let average = vertex_stretch::launch(gpu, &incident_starts, &incident, &stretches, &buffers.sigma);
        Ok(GpuState { gpu, coloring: patches.coloring, stretches, buffers, measure, average, relax: None })
    }

    fn run(&mut self, options: &RelaxOptions) -> Result<()> {
        if self.relax.as_ref().is_none_or(|(step, _)| *step != options.step) {
            let colors = 0..self.coloring.colors();
            let launch = |c| relax::launch(self.gpu, self.coloring.range(c), options.step, &self.buffers);
            self.relax = Some((options.step, colors.map(launch).collect()));
        }
        let relax = self.relax.iter().flat_map(|(_, launches)| launches);
        let sweep: Vec<&Launch> = [&self.measure, &self.average].into_iter().chain(relax).collect();
        for _ in 0..options.sweeps {
            self.gpu.submit(sweep.iter().copied())?;
        }
        Ok(())
    }

    fn read(&self) -> Result<(Vec<Lanes>, Vec<Stretch>)> {
        self.gpu.submit([&self.measure])?;
        Ok((self.gpu.download(&self.buffers.positions)?, self.gpu.download(&self.stretches)?))
    }
}
