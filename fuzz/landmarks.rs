//! Landmark files of every format. `cargo +nightly fuzz run landmarks`
#![no_main]

mod targets;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| targets::landmarks(bytes));
