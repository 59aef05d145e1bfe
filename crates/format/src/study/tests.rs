//! Studies that are read, and those that are refused.
