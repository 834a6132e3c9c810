//! What fuzzing has kept, replayed: no panic, and each input within seconds.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail")]

use std::fs;
use std::path::Path;
use std::time::Instant;

use fuzz::TARGETS;

#[test]
fn every_input_that_fuzzing_kept_is_stood() {
    for (name, target) in TARGETS {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("corpus")
            .join(name);
        let mut count = 0;
        for entry in fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            let begin = Instant::now();
            target(&fs::read(&path).unwrap());
            assert!(begin.elapsed().as_secs() < 20, "{}", path.display());
            count += 1;
        }
        assert!(count > 1, "{}: no corpus", folder.display());
    }
}
