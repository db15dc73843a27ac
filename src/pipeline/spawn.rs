//! The main job for other programs: jobs in, a channel of results out.

use super::flow::Flow;
use super::job::{MapJob, MapOptions};
use super::line::{JobId, Outcome};
use super::observer::Silent;
use super::stages::stream_maps;
use super::templates::Templates;
use crate::gpu::Device;
use crate::map::report::Report;
use crossbeam::channel::{Receiver, bounded};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

/// Results that may wait to be fetched.
const WAITING: usize = 4;

/// Bounds on the jobs in flight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Time for each job, in which it is worked on; none: any.
    pub timeout: Option<Duration>,
    /// Bytes of memory for all of them together, by estimate. Default: any.
    pub memory: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Limits { timeout: None, memory: u64::MAX }
    }
}

/// Maps pairs in the background, by the stages of `homeo batch`; results come through the channel as jobs end.
///
/// The iterator is asked for the next job when there is room for it, and no more once the receiver is dropped. Each job
/// writes its folder as `homeo map` does; nothing is skipped, and no ledger is kept.
///
/// ```no_run
/// use homeo::gpu::{Device, DeviceChoice};
/// use homeo::pipeline::{Limits, MapJob, MapOptions, spawn_maps};
///
/// # fn main() -> homeo::Result<()> {
/// let jobs = (0..100).map(|i| MapJob {
///     source: "template.obj".into(),
///     target: format!("scans/{i:03}.ply").into(),
///     landmarks: format!("scans/{i:03}.csv").into(),
///     target_landmarks: None,
///     hint: None,
///     texture: None,
///     out: format!("maps/{i:03}").into(),
/// });
/// let device = Device::open(&DeviceChoice::Auto)?;
/// for outcome in spawn_maps(jobs, MapOptions::default(), device, Limits::default()) {
///     match outcome.value {
///         Ok(report) => println!("{:03}: E_L2 {:.3}", outcome.id.0, report.distortion.forward.e_l2),
///         Err(error) => eprintln!("{:03}: {error}", outcome.id.0),
///     }
/// }
/// # Ok(())
/// # }
/// ```
pub fn spawn_maps<I>(jobs: I, options: MapOptions, device: Device, limits: Limits) -> Receiver<Outcome<Report>>
where
    I: IntoIterator<Item = MapJob>,
    I::IntoIter: Send + 'static,
{
    let (sender, results) = bounded(WAITING);
    let is_wanted = Arc::new(AtomicBool::new(true));
    let jobs = jobs.into_iter();
    thread::spawn(move || {
        let wanted = is_wanted.clone();
        let jobs = jobs.take_while(move |_| wanted.load(Ordering::SeqCst));
        let jobs = jobs.enumerate().map(|(i, job)| (JobId(i), job, None));
        let flow = Flow::watched(&Silent).bounded(limits.timeout, limits.memory);
        stream_maps(jobs, &options, &device, &flow, &Templates::default(), |outcome| {
            if sender.send(outcome).is_err() {
                is_wanted.store(false, Ordering::SeqCst);
            }
        });
    });
    results
}
