//! interim
use super::*;
use crate::error::Error;
use crate::gpu::Device;
use crate::map::report::Report;
/// interim
pub fn run_maps(
    jobs: Vec<MapJob>,
    options: &MapOptions,
    device: Device,
    observer: &dyn Observer,
    take: impl FnMut(Outcome<Report>),
) {
    std::thread::scope(|scope| {
        Line::start(scope, observer, jobs)
            .then(Stage::Load, |job, _| Ok(job))
            .then(Stage::Relax, move |_, _| {
                let _ = (&device, options);
                Err(Error::bug("not wired"))
            })
            .finish(take);
    });
}
