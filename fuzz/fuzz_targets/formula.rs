#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| hwasp_fuzz::formula(bytes));
