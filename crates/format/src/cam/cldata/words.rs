//! The words of CLDATA by what they mean to a tool path.

/// Words by which a file is told to be CLDATA though they may stand without a slash.
const TELLING: [&str; 20] = [
    "GOTO", "RAPID", "FINI", "PARTNO", "UNIT", "UNITS", "TOOL", "TLDATA", "LOADTL", "LOAD", "SPINDL", "FEDRAT",
    "MULTAX", "CUTCOM", "MSYS", "CSYS", "END", "PPRINT", "MACHIN", "COOLNT",
];

/// Words that move the tool, or change what positions mean, in a way that the reader does not know.
const MOVING: [&str; 31] = [
    "GODLTA", "GOHOME", "GOLFT", "GORGT", "GOFWD", "GOBACK", "GOUP", "GODOWN", "GO", "NURBS", "KNOT", "CNTRL",
    "SPLINE", "HELIX", "THREAD", "POCKET", "PMILL", "SMILL", "TLAXIS", "TRANS", "TRACUT", "COPY", "ORIGIN", "ROTATE",
    "ROTABL", "ROTHED", "CALL", "MACRO", "LOOPST", "JUMPTO", "IF",
];

/// Whether a word is one of CLDATA.
pub(crate) fn is_known(word: &str) -> bool {
    TELLING.contains(&word)
}

/// Whether a word, in upper case, moves the tool in a way that is not known.
pub(super) fn moves_unknown(word: &str) -> bool {
    MOVING.contains(&word) || word.contains('=')
}
