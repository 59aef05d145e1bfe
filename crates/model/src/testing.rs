//! How many of its cases a test tries: some with every commit, all of them by night.

/// Whether tests try all of their cases, as `.ci/nightly` does: with `STEAD_TESTS=all`.
pub fn is_all() -> bool {
    std::env::var_os("STEAD_TESTS").is_some_and(|word| word == "all")
}

/// How many of so many drawn cases are tried: a quarter, or all.
pub fn tried(all: usize) -> usize {
    if is_all() { all } else { all.div_ceil(4) }
}

/// The cases of a list that are tried: the first of every `of`, or all.
pub fn some<T>(of: usize, cases: impl IntoIterator<Item = T>) -> impl Iterator<Item = T> {
    cases.into_iter().step_by(if is_all() { 1 } else { of })
}
