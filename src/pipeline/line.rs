//! A line of stages: each on its own thread, a bounded channel between neighbours.

use super::observer::Observer;
use super::panics::catch;
use super::stages::Stage;
use crate::error::{Error, Result};
use crossbeam::channel::{Receiver, bounded};
use std::collections::BTreeMap;
use std::thread::Scope;
use std::time::Instant;

/// The number of a job in its run, from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct JobId(pub usize);

/// Finished values that may wait in front of a stage: enough to keep neighbours busy, and it bounds the memory in
/// flight to about two jobs a stage.
const WAITING: usize = 1;

/// A job on its way.
struct Job<T> {
    id: JobId,
    started: Instant,
    seconds: BTreeMap<&'static str, f64>,
    value: Result<T>,
}

/// What became of a job.
#[derive(Debug)]
pub struct Outcome<T> {
    /// The job.
    pub id: JobId,
    /// Its product or why there is none.
    pub value: Result<T>,
    /// Wall-clock seconds per stage passed, and `total`.
    pub seconds: BTreeMap<&'static str, f64>,
}

/// What a stage may know and say about the job at hand.
pub struct Step<'a> {
    job: JobId,
    stage: Stage,
    job_started: Instant,
    started: Instant,
    earlier: &'a BTreeMap<&'static str, f64>,
    observer: &'a dyn Observer,
}

impl Step<'_> {
    /// Tells the observer something about the job, in a few words.
    pub fn detail(&self, detail: impl AsRef<str>) {
        self.observer.stage_detail(self.job, self.stage, detail.as_ref());
    }

    /// The job at hand.
    pub fn job(&self) -> JobId {
        self.job
    }

    /// Wall-clock seconds of the stages so far, this one up to now, and `total` since the job started.
    pub fn seconds(&self) -> BTreeMap<&'static str, f64> {
        let mut seconds = self.earlier.clone();
        seconds.insert(self.stage.name(), self.started.elapsed().as_secs_f64());
        seconds.insert("total", self.job_started.elapsed().as_secs_f64());
        seconds
    }
}

/// The open end of a line of stages: jobs with values of type `T` come out of it.
///
/// Threads live in the scope the line was started in; state that a stage's closure owns lives on that stage's thread.
pub struct Line<'scope, 'env, T> {
    scope: &'scope Scope<'scope, 'env>,
    observer: &'env dyn Observer,
    jobs: Receiver<Job<T>>,
}

impl<'scope, 'env, T: Send + 'scope> Line<'scope, 'env, T> {
    /// Starts a line that is fed by an iterator; it is asked for the next job only when there is room.
    pub fn start<I>(scope: &'scope Scope<'scope, 'env>, observer: &'env dyn Observer, inputs: I) -> Self
    where
        I: IntoIterator<Item = T> + Send + 'scope,
    {
        let (sender, jobs) = bounded(WAITING);
        scope.spawn(move || {
            for (i, value) in inputs.into_iter().enumerate() {
                let job = Job { id: JobId(i), started: Instant::now(), seconds: BTreeMap::new(), value: Ok(value) };
                if sender.send(job).is_err() {
                    return; // the outcomes are no longer wanted
                }
            }
        });
        Line { scope, observer, jobs }
    }

    /// Appends a stage. A failed job passes it untouched; a panic in it becomes the job's error.
    pub fn then<U, F>(self, stage: Stage, mut work: F) -> Line<'scope, 'env, U>
    where
        U: Send + 'scope,
        F: FnMut(T, &Step) -> Result<U> + Send + 'scope,
    {
        let Line { scope, observer, jobs } = self;
        let (sender, done) = bounded(WAITING);
        scope.spawn(move || {
            for job in jobs {
                if sender.send(job.pass(stage, observer, &mut work)).is_err() {
                    return; // the outcomes are no longer wanted
                }
            }
        });
        Line { scope, observer, jobs: done }
    }

    /// Hands every outcome to `take`, in the order of the jobs, and returns when all are done.
    pub fn finish(self, mut take: impl FnMut(Outcome<T>)) {
        for job in self.jobs {
            let mut seconds = job.seconds;
            seconds.insert("total", job.started.elapsed().as_secs_f64());
            take(Outcome { id: job.id, value: job.value, seconds });
        }
    }
}

impl<T> Job<T> {
    fn pass<U>(self, stage: Stage, observer: &dyn Observer, work: &mut impl FnMut(T, &Step) -> Result<U>) -> Job<U> {
        let Job { id, started: job_started, mut seconds, value } = self;
        let value = value.and_then(|value| {
            observer.stage_started(id, stage);
            let started = Instant::now();
            let step = Step { job: id, stage, job_started, started, earlier: &seconds, observer };
            let result = catch(|| work(value, &step))
                .unwrap_or_else(|message| Err(Error::bug(format!("stage {} panicked: {message}", stage.name()))));
            let taken = started.elapsed().as_secs_f64();
            observer.stage_finished(id, stage, taken, result.as_ref().err());
            seconds.insert(stage.name(), taken);
            result
        });
        Job { id, started: job_started, seconds, value }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::ErrorKind;
    use crate::pipeline::Silent;
    use std::sync::Mutex;
    use std::thread;

    fn run(inputs: Vec<i32>, observer: &dyn Observer) -> Vec<Outcome<String>> {
        let mut outcomes = Vec::new();
        thread::scope(|scope| {
            let mut seen = 0; // state of one stage, as the device is
            Line::start(scope, observer, inputs)
                .then(Stage::Load, |x: i32, step| {
                    step.detail(format!("read {x}"));
                    if x < 0 { Err(Error::input("negative")) } else { Ok(f64::from(x)) }
                })
                .then(Stage::Relax, move |x, _| {
                    seen += 1;
                    assert!(x != 1313.0, "unlucky");
                    Ok((seen, x))
                })
                .then(Stage::Write, |(seen, x), step| {
                    assert!(step.seconds().contains_key("load") && step.seconds().contains_key("total"));
                    Ok(format!("{seen}: {x}"))
                })
                .finish(|outcome| outcomes.push(outcome));
        });
        outcomes
    }

    #[test]
    fn outcomes_come_in_the_order_of_the_jobs() {
        let outcomes = run((0..50).collect(), &Silent);
        for (i, outcome) in outcomes.iter().enumerate() {
            assert_eq!(outcome.id, JobId(i));
            assert_eq!(outcome.value.as_deref(), Ok(format!("{}: {i}", i + 1).as_str()));
            assert_eq!(outcome.seconds.keys().copied().collect::<Vec<_>>(), ["load", "relax", "total", "write"]);
        }
        assert_eq!(outcomes.len(), 50);
    }

    #[test]
    fn a_failed_job_stops_at_its_stage_and_harms_no_other() {
        let outcomes = run(vec![1, -1, 2], &Silent);
        assert_eq!(outcomes[1].value.as_ref().map_err(|e| e.kind), Err(ErrorKind::Input));
        assert_eq!(outcomes[1].seconds.keys().copied().collect::<Vec<_>>(), ["load", "total"]);
        assert_eq!(outcomes[2].value.as_deref(), Ok("2: 2"));
    }

    #[test]
    fn a_panic_becomes_the_error_of_its_job_and_names_the_stage() {
        let outcomes = run(vec![12, 1313, 14], &Silent);
        let error = outcomes[1].value.as_ref().expect_err("1313 panics");
        assert_eq!(error.kind, ErrorKind::Bug);
        assert!(error.what.contains("stage relax panicked: unlucky"), "{error}");
        assert_eq!(outcomes[2].value.as_deref(), Ok("3: 14"));
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
