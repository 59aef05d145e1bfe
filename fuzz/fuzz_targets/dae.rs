#![no_main]

use libfuzzer_sys::fuzz_target;
use stead_run_files::fuzzing::Reader;

fuzz_target!(|bytes: &[u8]| {
    if let Err(broken) = Reader::Dae.check(bytes) {
        panic!("{broken}");
    }
});
