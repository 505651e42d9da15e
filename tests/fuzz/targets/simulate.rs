//! Any bits as the numbers of a scene.

#![no_main]

use iva_fuzz::{judge, refusal, scene::Scene};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|scene: Scene| {
    if let Err(invalid) = judge::examine(&scene) {
        refusal::check_invalid(&invalid);
    }
});
