//! Promises of `homeo batch`: failures stay with their job, nothing is done twice or lost, bytes do not depend on company.

#[path = "common/islands.rs"]
#[allow(dead_code)] // the cells' colours are for tests of textures
mod islands;

use homeo::mesh::io::write_obj;
use homeo::shape::SplitMix;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, File};
use std::io::BufWriter;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// A folder of one test with inputs in it.
struct Night(PathBuf);

impl Night {
    /// Balls of a few hundred triangles, `jobs` of them as targets of one template, and their manifest.
    fn new(test: &str, jobs: usize) -> Self {
        let dir = std::env::temp_dir().join(format!("homeo-batch-{test}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&dir);
        fs::create_dir_all(&dir).expect("the temporary folder is writable");
        let night = Night(dir);
        night.ball("template.obj", 6, 1.0);
        let mut manifest = "id,source,target,landmarks\n".to_owned();
        for i in 0..jobs {
            night.ball(&format!("scan_{i}.obj"), 5, 1.2 + 0.03 * i as f64);
            manifest += &format!("job_{i:03},template.obj,scan_{i}.obj,landmarks.csv\n");
        }
        night.add("manifest.csv", &manifest);
        // Vertices of the octahedron both balls are made from, by their places.
        night.add(
            "landmarks.csv",
            "name,sx,sy,sz,tx,ty,tz\na,1,0,0,1,0,0\nb,0,1,0,0,1,0\nc,0,0,1,0,0,2\nd,-1,0,0,-1,0,0\n",
        );
        night
    }

    /// An octahedron with `n` segments an edge, blown up to a sphere and drawn out along z.
    fn ball(&self, name: &str, n: usize, height: f64) {
        let mut mesh = islands::ball(n, [0, 1, 2, 3, 4, 5, 6, 7]);
        mesh.uv.values.clear();
        mesh.uv.corners.clear();
        mesh.positions.iter_mut().for_each(|p| p.z *= height);
        let mut file = BufWriter::new(File::create(self.0.join(name)).expect("writable"));
        write_obj(&mut file, Path::new(""), &mesh, &mesh.positions).expect("writable");
    }

    fn add(&self, name: &str, content: &str) {
        fs::write(self.0.join(name), content).expect("the temporary folder is writable");
    }

    fn append(&self, row: &str) {
        let manifest = fs::read_to_string(self.0.join("manifest.csv")).expect("there");
        self.add("manifest.csv", &(manifest + row + "\n"));
    }

    /// The command on the manifest into a folder; the relaxation that takes the least time.
    fn batch(&self, out: &str, more: &[&str]) -> Command {
        let mut command = self.thorough_batch(out);
        command.args(["--relax", "patch"]).args(more);
        command
    }

    /// The same with the default relaxation.
    fn thorough_batch(&self, out: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_homeo"));
        command.env_remove("RUST_BACKTRACE").env_remove("HOMEO_REQUIRE_GPU");
        command.arg("batch").arg(self.0.join("manifest.csv")).arg("--out").arg(self.0.join(out));
        command.args(["--image", "0", "--device", "cpu", "--json", "--no-report"]);
        command
    }

    fn run(&self, out: &str, more: &[&str]) -> Finished {
        Finished::of(self.batch(out, more).output().expect("the program starts"))
    }

    fn rows(&self, file: &str) -> Vec<Value> {
        let text = fs::read_to_string(self.0.join(file)).unwrap_or_else(|e| panic!("{file}: {e}"));
        text.lines().map(|line| serde_json::from_str(line).unwrap_or_else(|e| panic!("{file}: {line}: {e}"))).collect()
    }

    /// Ids with their status.
    fn statuses(&self, file: &str) -> Vec<(String, String)> {
        let text = |row: &Value, key: &str| row[key].as_str().unwrap_or_default().to_owned();
        self.rows(file).iter().map(|row| (text(row, "id"), text(row, "status"))).collect()
    }

    /// What lies in an output folder, by name.
    fn names(&self, out: &str) -> BTreeSet<String> {
        let entries = fs::read_dir(self.0.join(out)).expect("there");
        entries.flatten().map(|entry| entry.file_name().to_string_lossy().into_owned()).collect()
    }

    /// The bytes of all results that may not vary: reports hold times and memory.
    fn results(&self, out: &str) -> BTreeMap<PathBuf, Vec<u8>> {
        let mut files = BTreeMap::new();
        let root = self.0.join(out);
        let mut folders: Vec<PathBuf> =
            fs::read_dir(&root).expect("there").flatten().map(|e| e.path()).filter(|p| p.is_dir()).collect();
        while let Some(folder) = folders.pop() {
            for path in fs::read_dir(folder).expect("there").flatten().map(|entry| entry.path()) {
                if path.is_dir() {
                    folders.push(path);
                } else if !path.ends_with("report.json") {
                    let bytes = fs::read(&path).expect("readable");
                    files.insert(path.strip_prefix(&root).expect("below").to_owned(), bytes);
                }
            }
        }
        files
    }
}

impl Drop for Night {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// A run that ended.
struct Finished {
    code: Option<i32>,
    summary: Value,
    stderr: String,
}

impl Finished {
    fn of(output: Output) -> Self {
        let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
        Finished {
            code: output.status.code(),
            summary: serde_json::from_slice(&output.stdout).unwrap_or_default(),
            stderr,
        }
    }

    fn counts(&self) -> [u64; 4] {
        ["ok", "skipped", "failed", "left"].map(|key| self.summary[key].as_u64().unwrap_or(u64::MAX))
    }
}

fn all(status: &str, jobs: usize) -> Vec<(String, String)> {
    (0..jobs).map(|i| (format!("job_{i:03}"), status.to_owned())).collect()
}

#[test]
fn failures_stay_with_their_jobs_and_each_is_named() {
    let night = Night::new("failures", 3);
    night.add("torn.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 0 -1\nf 1 2 3\nf 1 2 4\nf 1 2 5\n");
    night.append("missing,template.obj,nowhere.obj,landmarks.csv");
    night.append("torn,template.obj,torn.obj,landmarks.csv");
    let done = night.run("out", &[]);
    assert_eq!((done.code, done.counts()), (Some(6), [3, 0, 2, 0]), "{}", done.stderr);
    let mut expected = all("ok", 3);
    expected.extend(["missing", "torn"].map(|id| (id.to_owned(), "failed".to_owned())));
    assert_eq!(night.statuses("out/results.jsonl"), expected);
    let failures = night.rows("out/failed.jsonl");
    let part = |i: usize, key: &str| failures[i][key].as_str().unwrap_or_default().to_owned();
    assert_eq!([part(0, "id"), part(0, "stage")], ["missing", "load"]);
    assert!(part(0, "file").ends_with("nowhere.obj") && failures[0]["code"] == 3);
    assert_eq!([part(1, "id"), part(1, "stage")], ["torn", "check"]);
    assert!(part(1, "element").contains("edge") || part(1, "what").contains("edge"), "{}", failures[1]);
    assert_eq!(part(1, "input").len(), 64, "the fingerprint of the inputs");
    let kept = ["job_000", "job_001", "job_002", "results.jsonl", "failed.jsonl", "batch.json"];
    assert!(night.names("out").iter().all(|n| n.starts_with('.') || kept.contains(&n.as_str()) || n == "batch.html"));
}

#[test]
fn what_is_done_is_skipped_until_inputs_or_options_change() {
    let night = Night::new("resume", 4);
    night.append("bad,template.obj,nowhere.obj,landmarks.csv");
    assert_eq!(night.run("out", &[]).counts(), [4, 0, 1, 0]);
    let before = night.results("out");
    assert_eq!(night.run("out", &[]).counts(), [0, 4, 1, 0], "failed jobs are tried again");
    let rows = night.rows("out/results.jsonl");
    assert!(rows[0]["status"] == "skipped" && rows[0]["distortion"]["forward"]["e_l2"].as_f64() > Some(0.9));
    assert_eq!(night.results("out"), before);
    let files = |name: &str| name.ends_with(".obj") || name == "landmarks.csv";
    fs::create_dir(night.0.join("moved")).expect("writable");
    for name in night.names(".").into_iter().filter(|name| files(name)) {
        fs::copy(night.0.join(&name), night.0.join("moved").join(&name)).expect("writable");
    }
    let manifest = fs::read_to_string(night.0.join("manifest.csv")).expect("there");
    night.add("manifest.csv", &manifest.replace(",template", ",moved/template").replace(",scan", ",moved/scan"));
    assert_eq!(night.run("out", &[]).counts(), [0, 4, 1, 0], "the same bytes in another place");
    night.add("manifest.csv", &manifest);
    night.ball("scan_2.obj", 5, 1.5);
    night.ball("nowhere.obj", 5, 1.1);
    assert_eq!(night.run("out", &[]).counts(), [2, 3, 0, 0], "one has changed, one is there now");
    assert_eq!(night.rows("out/failed.jsonl"), Vec::<Value>::new());
    assert_eq!(night.run("out", &["--seed", "5"]).counts(), [5, 0, 0, 0], "other options");
    fs::remove_file(night.0.join("out/job_001/job.json")).expect("there");
    assert_eq!(night.run("out", &["--seed", "5"]).counts(), [1, 4, 0, 0], "a folder without its seal is done again");
}

#[test]
fn bytes_do_not_depend_on_threads_shards_or_company() {
    let night = Night::new("bytes", 8);
    assert_eq!(night.run("one", &["--threads", "1"]).code, Some(0));
    assert_eq!(night.run("many", &["--threads", "4"]).code, Some(0));
    let one = night.results("one");
    assert!(one.len() > 8 * 5 && one == night.results("many"));
    for part in ["1/3", "2/3", "3/3"] {
        assert_eq!(night.run("shards", &["--shard", part]).code, Some(0));
    }
    assert!(one == night.results("shards"));
    let mut merge = Command::new(env!("CARGO_BIN_EXE_homeo"));
    merge.args(["batch", "--json", "--merge"]).arg(night.0.join("shards"));
    let merged = Finished::of(merge.output().expect("the program starts"));
    assert_eq!((merged.code, merged.counts()), (Some(0), [8, 0, 0, 0]), "{}", merged.stderr);
    assert_eq!(night.statuses("shards/results.jsonl"), night.statuses("one/results.jsonl"));
}

#[test]
fn a_merge_says_which_jobs_are_missing_or_there_twice() {
    let night = Night::new("merge", 6);
    let merge = || {
        let mut merge = Command::new(env!("CARGO_BIN_EXE_homeo"));
        Finished::of(merge.args(["batch", "--merge"]).arg(night.0.join("out")).output().expect("the program starts"))
    };
    assert_eq!(merge().code, Some(3), "nothing was run yet");
    night.run("out", &["--shard", "1/2"]);
    let done = night.statuses("out/results-1-of-2.jsonl");
    let missing = all("ok", 6).into_iter().find(|job| !done.contains(job)).expect("the other shard has jobs").0;
    let merged = merge();
    assert_eq!(merged.code, Some(3));
    assert!(merged.stderr.contains("without a result") && merged.stderr.contains(&missing), "{}", merged.stderr);
    night.run("out", &["--shard", "2/2"]);
    assert_eq!(merge().code, Some(0));
    fs::copy(night.0.join("out/results-1-of-2.jsonl"), night.0.join("out/results-1-of-3.jsonl")).expect("writable");
    assert!(merge().stderr.contains("several results"));
    fs::remove_file(night.0.join("out/results-1-of-3.jsonl")).expect("there");
    fs::remove_dir_all(night.0.join("out/job_003")).expect("there");
    assert!(merge().stderr.contains("job_003"));
}

#[test]
fn a_job_that_takes_too_long_is_given_up_alone() {
    let night = Night::new("timeout", 2);
    night.ball("large.obj", 70, 1.3);
    night.append("large,large.obj,large.obj,landmarks.csv");
    night.append("last,template.obj,scan_0.obj,landmarks.csv");
    let started = Instant::now();
    let mut batch = night.thorough_batch("out");
    let done = Finished::of(batch.args(["--tolerance", "0", "--timeout", "4"]).output().expect("the program starts"));
    assert_eq!((done.code, done.counts()), (Some(6), [3, 0, 1, 0]), "{} {}", done.summary, done.stderr);
    let failure = &night.rows("out/failed.jsonl")[0];
    assert!(failure["id"] == "large" && failure["kind"] == "late", "{failure}");
    assert!(started.elapsed() < Duration::from_secs(120), "it did not run to its end");
}

#[test]
fn no_job_is_begun_after_too_many_have_failed() {
    let night = Night::new("max-fail", 0);
    for i in 0..40 {
        night.append(&format!("bad_{i},template.obj,nowhere_{i}.obj,landmarks.csv"));
    }
    let done = night.run("out", &["--max-fail", "3"]);
    let [ok, _, failed, left] = done.counts();
    assert!(done.code == Some(6) && ok == 0 && failed == 3 && left == 37, "{}", done.summary);
}

#[test]
fn a_manifest_that_is_wrong_is_refused_before_anything_is_done() {
    let night = Night::new("manifest", 1);
    night.append("job_000,template.obj,scan_0.obj,landmarks.csv");
    let done = night.run("out", &[]);
    assert!(done.code == Some(3) && !night.0.join("out").exists(), "{}", done.stderr);
    assert!(
        done.summary["error"]["what"].as_str().is_some_and(|what| what.contains("given twice")),
        "{}",
        done.summary
    );
}

/// Sends a signal by its name.
fn signal(child: &Child, name: &str) {
    let sent = Command::new("kill").args([&format!("-{name}"), &child.id().to_string()]).stderr(Stdio::null()).status();
    sent.expect("there is a kill program");
}

#[test]
#[cfg(unix)]
fn a_killed_run_loses_only_the_jobs_at_hand() {
    const JOBS: usize = 100;
    let night = Night::new("kill", JOBS);
    assert_eq!(night.run("calm", &[]).code, Some(0));
    let mut random = SplitMix::new(7);
    let (mut kills, mut pause) = (0, Duration::from_millis(120));
    while kills < 20 {
        let mut child = night.batch("out", &[]).stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("it starts");
        sleep(pause.mul_f64(0.2 + random.unit()));
        if child.try_wait().expect("a child").is_some() {
            // All was done too early: from here on with changed options, and in shorter steps.
            fs::remove_dir_all(night.0.join("out")).expect("there");
            pause = pause.mul_f64(0.5);
            continue;
        }
        signal(&child, "KILL");
        child.wait().expect("a child");
        kills += 1;
    }
    let done = night.run("out", &[]);
    assert_eq!(done.code, Some(0), "{}", done.stderr);
    let [ok, skipped, ..] = done.counts();
    assert_eq!(ok + skipped, JOBS as u64);
    let ids: Vec<String> = night.statuses("out/results.jsonl").into_iter().map(|(id, _)| id).collect();
    assert_eq!(ids, all("", JOBS).into_iter().map(|(id, _)| id).collect::<Vec<_>>(), "every job exactly once");
    assert!(night.results("out") == night.results("calm"), "all bytes as in the undisturbed run");
    let leftovers: Vec<String> =
        night.names("out").into_iter().filter(|n| n.starts_with('.') && n != ".lock").collect();
    assert_eq!(leftovers, Vec::<String>::new());
}

#[test]
#[cfg(unix)]
fn an_interrupt_finishes_the_jobs_at_hand() {
    let night = Night::new("interrupt", 150);
    let child = night.batch("out", &[]).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it starts");
    let results = night.0.join("out/results.jsonl");
    while fs::metadata(&results).map_or(0, |data| data.len()) == 0 {
        sleep(Duration::from_millis(5));
    }
    signal(&child, "INT");
    let done = Finished::of(child.wait_with_output().expect("a child"));
    let [ok, skipped, failed, left] = done.counts();
    assert!(done.code == Some(130) && skipped + failed == 0 && ok > 0 && left > 0, "{:?} {}", done.code, done.summary);
    let folders: BTreeSet<String> = night.names("out").into_iter().filter(|n| n.starts_with("job_")).collect();
    let rows: BTreeSet<String> = night.statuses("out/results.jsonl").into_iter().map(|(id, _)| id).collect();
    assert_eq!(folders, rows, "every job that was begun was finished");
    assert!(!night.names("out").iter().any(|name| name.contains(".tmp-")));
}

#[test]
fn plans_are_programs_that_their_readers_accept() {
    let night = Night::new("plans", 1);
    for (engine, file) in [("slurm", "plan_slurm.sh"), ("dask", "plan_dask.py"), ("openjd", "plan_openjd.yaml")] {
        let done = night.run("out with space", &["--plan", engine, "--shards", "12", "--timeout", "60"]);
        assert_eq!(done.code, Some(0), "{}", done.stderr);
        let text = fs::read_to_string(night.0.join("out with space").join(file)).expect("the plan is there");
        for word in ["manifest.csv", "out with space", "12", "--timeout", "--relax"] {
            assert!(text.contains(word), "{file} has no {word}:\n{text}");
        }
    }
    let syntax = |program: &str, arguments: &[&str], file: &str| {
        let mut command = Command::new(program);
        let output = command.args(arguments).arg(night.0.join("out with space").join(file)).output();
        if let Ok(output) = output {
            assert!(output.status.success(), "{file}: {}", String::from_utf8_lossy(&output.stderr));
        }
    };
    syntax("bash", &["-n"], "plan_slurm.sh");
    syntax("python3", &["-c", "import ast, sys; ast.parse(open(sys.argv[1]).read())"], "plan_dask.py");
}

/// A file system of its own of `size` bytes; none where mounting is not allowed.
#[cfg(target_os = "linux")]
struct SmallDisk(PathBuf);

#[cfg(target_os = "linux")]
impl SmallDisk {
    fn mount(place: PathBuf, size: usize) -> Option<Self> {
        fs::create_dir_all(&place).expect("writable");
        let mut mount = Command::new("mount");
        mount.args(["-t", "tmpfs", "-o", &format!("size={size}"), "tmpfs"]).arg(&place).stderr(Stdio::null());
        mount.status().is_ok_and(|status| status.success()).then_some(SmallDisk(place))
    }
}

#[cfg(target_os = "linux")]
impl Drop for SmallDisk {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg("--lazy").arg(&self.0).status();
    }
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_fails_the_jobs_that_do_not_fit_and_nothing_else() {
    let night = Night::new("disk", 40);
    let Some(disk) = SmallDisk::mount(night.0.join("out"), 1 << 20) else {
        eprintln!("SKIPPED: mounting a small disk takes root");
        return;
    };
    let done = night.run("out", &[]);
    let [ok, _, failed, left] = done.counts();
    assert!(
        done.code == Some(6) && ok > 2 && failed > 2 && ok + failed == 40 && left == 0,
        "{} {}",
        done.summary,
        done.stderr
    );
    for failure in night.rows("out/failed.jsonl") {
        assert!(failure["what"].as_str().is_some_and(|what| what.contains("space")), "{failure}");
    }
    assert!(!night.names("out").iter().any(|name| name.contains(".tmp-")));
    for (id, status) in night.statuses("out/results.jsonl") {
        assert_eq!(night.0.join("out").join(&id).join("report.json").is_file(), status == "ok", "{id}");
    }
    drop(disk);
}
