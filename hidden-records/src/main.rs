//! hidden-records
fn main() {}
