//! Mesh files of every format. `cargo +nightly fuzz run mesh`
#![no_main]

mod targets;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| targets::mesh(bytes));
