//! The words of CLDATA by what they mean to a tool path.

/// Words by which a file is told to be CLDATA though they may stand without a slash.
const TELLING: [&str; 20] = [
    "GOTO", "RAPID", "FINI", "PARTNO", "UNIT", "UNITS", "TOOL", "TLDATA", "LOADTL", "LOAD", "SPINDL", "FEDRAT",
    "MULTAX", "CUTCOM", "MSYS", "CSYS", "END", "PPRINT", "MACHIN", "COOLNT",
];

/// Words that leave the path of the tool as it is: texts, pictures, auxiliary functions, tolerances of what is computed
/// already.
const HARMLESS: [&str; 38] = [
    "AIR", "ARCSLP", "AUTOPS", "AUXFUN", "BREAK", "CLAMP", "CLEARP", "CLPRNT", "COOLNT", "DELAY", "DISPLY", "END",
    "HEADER", "INSERT", "INTOL", "ISN", "LEADER", "LETTER", "LINTOL", "MACHIN", "MCHTOL", "NOPOST", "OPSTOP", "OUTTOL",
    "PAINT", "PARTNO", "PLABEL", "PPLOT", "PPRINT", "PROGRM", "REMARK", "REWIND", "SELCTL", "SELECT", "SEQNO", "STOP",
    "TOLER", "TPRINT",
];

/// Whether a word is one of CLDATA.
pub(crate) fn is_known(word: &str) -> bool {
    TELLING.contains(&word)
}

/// Whether a word, in upper case, leaves the path of the tool as it is.
pub(super) fn is_harmless(word: &str) -> bool {
    HARMLESS.contains(&word)
}
