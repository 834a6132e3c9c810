//! build-fmu
fn main() {}
