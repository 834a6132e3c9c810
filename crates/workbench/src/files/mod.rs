//! Files: records (CSV, Parquet, Excel), tables of results, writing whole or not at all, and journals of long work.

pub mod atomic;
pub mod journal;
pub mod record;
pub mod table;
