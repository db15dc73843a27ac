//! A single output file appears complete or not at all.

use homeo::ErrorKind;
use homeo::stage::write::write_file;
use std::fs;
use std::io::Write;

#[test]
fn a_file_appears_complete_or_not_at_all() {
    let parent = std::env::temp_dir().join(format!("homeo-file-{}/parent", std::process::id()));
    let path = parent.join("a.glb");
    write_file(&path, |out| out.write_all(b"old")).expect("the place is free");
    fs::write(parent.join(format!(".a.glb.tmp-{}", u32::MAX)), "left behind").expect("writable");
    let failing = |out: &mut dyn Write| {
        out.write_all(b"half")?;
        Err(std::io::Error::from(std::io::ErrorKind::StorageFull))
    };
    let error = write_file(&path, failing).expect_err("the disk is full");
    assert!(error.file.ends_with("a.glb"), "{error}");
    assert_eq!(fs::read(&path).expect("still there"), b"old");
    write_file(&path, |out| out.write_all(b"new")).expect("an earlier file may be replaced");
    assert_eq!(fs::read(&path).expect("written"), b"new");
    assert_eq!(fs::read_dir(&parent).expect("readable").count(), 1, "nothing is left behind");
    let error = write_file(&parent, |_| Ok(())).expect_err("a folder is no file");
    assert_eq!(error.kind, ErrorKind::Usage);
    fs::remove_dir_all(parent.with_file_name("")).expect("it is there");
}
