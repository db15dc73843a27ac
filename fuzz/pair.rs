//! Whole maps of small random pairs. `cargo +nightly fuzz run pair`
#![no_main]

mod targets;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| targets::pair(bytes));
