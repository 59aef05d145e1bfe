//! Shards, journals and tables.
