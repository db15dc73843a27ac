//! A line of stages: threads of its own for each, a bounded channel between neighbours.

use super::flow::Flow;
use super::flow::budget::Reservation;
use super::panics::catch;
use super::stages::Stage;
use crate::deadline::{Deadline, check, within};
use crate::error::{Error, Result};
use crossbeam::channel::{Receiver, bounded};
use std::collections::BTreeMap;
use std::sync::Arc;
use std::thread::Scope;
use std::time::Instant;

/// The number of a job in its run, from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct JobId(pub usize);

/// Finished values that may wait in front of a stage: enough to keep neighbours busy. How much memory they may hold is
/// for [`Flow`] to say.
const WAITING: usize = 1;

/// A job on its way.
struct Job<'env, T> {
    id: JobId,
    seconds: BTreeMap<&'static str, f64>,
    held: Reservation<'env>,
    failed_in: Option<Stage>,
    value: Result<T>,
}

/// What became of a job.
#[derive(Debug)]
pub struct Outcome<T> {
    /// The job.
    pub id: JobId,
    /// Its product or why there is none.
    pub value: Result<T>,
    /// The stage it failed in, if it did.
    pub failed_in: Option<Stage>,
    /// Wall-clock seconds per stage passed, and `total`, their sum: without the time that the job waited for others.
    pub seconds: BTreeMap<&'static str, f64>,
}

/// What a stage may know and say about the job at hand.
pub struct Step<'a> {
    job: JobId,
    stage: Stage,
    started: Instant,
    earlier: &'a BTreeMap<&'static str, f64>,
    flow: &'a Flow<'a>,
}

impl Step<'_> {
    /// Tells the observer something about the job, in a few words.
    pub fn detail(&self, detail: impl AsRef<str>) {
        self.flow.observer.stage_detail(self.job, self.stage, detail.as_ref());
    }

    /// The job at hand.
    pub fn job(&self) -> JobId {
        self.job
    }

    /// Wall-clock seconds of the stages so far, this one up to now, and `total`, their sum.
    pub fn seconds(&self) -> BTreeMap<&'static str, f64> {
        let mut seconds = self.earlier.clone();
        seconds.insert(self.stage.name(), self.started.elapsed().as_secs_f64());
        with_total(seconds)
    }
}

fn with_total(mut seconds: BTreeMap<&'static str, f64>) -> BTreeMap<&'static str, f64> {
    let total = seconds.values().sum();
    seconds.insert("total", total);
    seconds
}

/// The open end of a line of stages: jobs with values of type `T` come out of it.
///
/// Threads live in the scope the line was started in.
pub struct Line<'scope, 'env, T> {
    scope: &'scope Scope<'scope, 'env>,
    flow: &'env Flow<'env>,
    jobs: Receiver<Job<'env, T>>,
}

impl<'scope, 'env, T: Send + 'scope> Line<'scope, 'env, T> {
    /// Starts a line that is fed by an iterator of jobs, each with the bytes it will need; it is asked for the next job
    /// only when there is room, and waits until the flow's memory allows for the job.
    pub fn start<I>(scope: &'scope Scope<'scope, 'env>, flow: &'env Flow<'env>, inputs: I) -> Self
    where
        I: IntoIterator<Item = (JobId, u64, T)>,
        I::IntoIter: Send + 'scope,
    {
        let (sender, jobs) = bounded(WAITING);
        let inputs = inputs.into_iter();
        scope.spawn(move || {
            for (id, bytes, value) in inputs {
                let held = flow.budget.reserve(bytes);
                if sender.send(Job::new(id, held, value)).is_err() {
                    return; // the outcomes are no longer wanted
                }
            }
        });
        Line { scope, flow, jobs }
    }

    /// Appends a stage, with as many threads as the flow has cores. A failed job passes it untouched; a panic in it
    /// becomes the job's error.
    pub fn then<U, F>(self, stage: Stage, work: F) -> Line<'scope, 'env, U>
    where
        U: Send + 'scope,
        F: Fn(T, &Step) -> Result<U> + Send + Sync + 'scope,
    {
        let Line { scope, flow, jobs } = self;
        let (sender, done) = bounded(WAITING);
        let work = Arc::new(work);
        for _ in 0..flow.cores.count() {
            let (jobs, sender, work) = (jobs.clone(), sender.clone(), work.clone());
            scope.spawn(move || {
                for job in jobs {
                    if sender.send(job.pass(stage, flow, &*work)).is_err() {
                        return; // the outcomes are no longer wanted
                    }
                }
            });
        }
        Line { scope, flow, jobs: done }
    }

    /// Hands every outcome to `take` as soon as there is one, and returns when all jobs are done.
    pub fn finish(self, mut take: impl FnMut(Outcome<T>)) {
        for Job { id, seconds, held, failed_in, value } in self.jobs {
            take(Outcome { id, value, failed_in, seconds: with_total(seconds) });
            drop(held);
        }
    }
}

impl<'env, T> Job<'env, T> {
    fn new(id: JobId, held: Reservation<'env>, value: T) -> Self {
        Job { id, seconds: BTreeMap::new(), held, failed_in: None, value: Ok(value) }
    }

    fn pass<U>(self, stage: Stage, flow: &Flow, work: &impl Fn(T, &Step) -> Result<U>) -> Job<'env, U> {
        let Job { id, mut seconds, held, mut failed_in, value } = self;
        let value = value.and_then(|value| {
            let _core = flow.cores.take(stage);
            flow.observer.stage_started(id, stage);
            let started = Instant::now();
            let step = Step { job: id, stage, started, earlier: &seconds, flow };
            let spent: f64 = seconds.values().sum();
            let deadline = flow.timeout.map(|limit| Deadline::new(started, spent, limit));
            let result = catch(|| within(deadline, || check().and_then(|()| work(value, &step))))
                .unwrap_or_else(|message| Err(Error::bug(format!("stage {} panicked: {message}", stage.name()))));
            let taken = started.elapsed().as_secs_f64();
            flow.observer.stage_finished(id, stage, taken, result.as_ref().err());
            seconds.insert(stage.name(), taken);
            failed_in = result.is_err().then_some(stage);
            result
        });
        Job { id, seconds, held, failed_in, value }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::ErrorKind;
    use crate::pipeline::{Observer, Silent};
    use std::sync::Mutex;
    use std::thread;

    fn run(inputs: Vec<i32>, observer: &dyn Observer) -> Vec<Outcome<String>> {
        let mut outcomes = Vec::new();
        let flow = Flow::watched(observer);
        let jobs = inputs.into_iter().enumerate().map(|(i, x)| (JobId(i), 0, x));
        thread::scope(|scope| {
            Line::start(scope, &flow, jobs)
                .then(Stage::Load, |x: i32, step| {
                    step.detail(format!("read {x}"));
                    if x < 0 { Err(Error::input("negative")) } else { Ok(f64::from(x)) }
                })
                .then(Stage::Relax, |x, _| {
                    assert!(x != 1313.0, "unlucky");
                    Ok(x)
                })
                .then(Stage::Write, |x, step| {
                    assert!(step.seconds().contains_key("load") && step.seconds().contains_key("total"));
                    Ok(format!("{x}"))
                })
                .finish(|outcome| outcomes.push(outcome));
        });
        outcomes.sort_by_key(|outcome| outcome.id);
        outcomes
    }

    #[test]
    fn every_job_comes_out_once() {
        let outcomes = run((0..50).collect(), &Silent);
        for (i, outcome) in outcomes.iter().enumerate() {
            assert_eq!(outcome.id, JobId(i));
            assert_eq!(outcome.value.as_deref(), Ok(i.to_string().as_str()));
            assert_eq!(outcome.seconds.keys().copied().collect::<Vec<_>>(), ["load", "relax", "total", "write"]);
        }
        assert_eq!(outcomes.len(), 50);
    }

    #[test]
    fn a_failed_job_stops_at_its_stage_and_harms_no_other() {
        let outcomes = run(vec![1, -1, 2], &Silent);
        assert_eq!(outcomes[1].value.as_ref().map_err(|e| e.kind), Err(ErrorKind::Input));
        assert_eq!(outcomes[1].seconds.keys().copied().collect::<Vec<_>>(), ["load", "total"]);
        assert_eq!(outcomes[2].value.as_deref(), Ok("2"));
    }

    #[test]
    fn a_panic_becomes_the_error_of_its_job_and_names_the_stage() {
        let outcomes = run(vec![12, 1313, 14], &Silent);
        let error = outcomes[1].value.as_ref().expect_err("1313 panics");
        assert_eq!(error.kind, ErrorKind::Bug);
        assert!(error.what.contains("stage relax panicked: unlucky"), "{error}");
        assert_eq!(outcomes[2].value.as_deref(), Ok("14"));
    }

    #[test]
    fn the_observer_sees_every_step() {
        struct Log(Mutex<Vec<String>>);
        impl Observer for Log {
            fn stage_started(&self, job: JobId, stage: Stage) {
                self.0.lock().expect("no panics here").push(format!("{} {} started", job.0, stage.name()));
            }
            fn stage_detail(&self, job: JobId, stage: Stage, detail: &str) {
                self.0.lock().expect("no panics here").push(format!("{} {} {detail}", job.0, stage.name()));
            }
            fn stage_finished(&self, job: JobId, stage: Stage, _: f64, error: Option<&Error>) {
                let state = if error.is_some() { "failed" } else { "finished" };
                self.0.lock().expect("no panics here").push(format!("{} {} {state}", job.0, stage.name()));
            }
        }
        let log = Log(Mutex::default());
        run(vec![-5], &log);
        assert_eq!(log.0.into_inner().expect("no panics here"), ["0 load started", "0 load read -5", "0 load failed"]);
    }
}
