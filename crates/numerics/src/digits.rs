//! Numbers as text, for files and messages.

/// A number with a fixed count of decimals; what rounds to zero has no sign.
pub fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(digits) if digits.bytes().all(|byte| byte == b'0' || byte == b'.') => digits.to_owned(),
        _ => text,
    }
}

/// A number with at most so many decimals, without zeros at its end.
///
/// ```
/// # use stead_numerics::digits::trimmed;
/// assert_eq!([trimmed(0.5, 4), trimmed(20.0, 4), trimmed(100.0, 0)], ["0.5", "20", "100"]);
/// ```
pub fn trimmed(value: f64, decimals: usize) -> String {
    let text = fixed(value, decimals);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// A number with three significant digits, or all digits before the point where there are more; very small and very
/// large ones with a power of ten.
pub fn figures(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let exponent = libm::floor(libm::log10(value.abs()));
    if (-4.0..9.0).contains(&exponent) {
        fixed(value, (2.0 - exponent).max(0.0) as usize)
    } else {
        format!("{value:.2e}")
    }
}
