//! What a forces file declares.

use super::material::Material;
use crate::Word;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::ops::Bound::Included;
use stead_format::cam::gcode::Machine;
use stead_format::cam::{CamFormat, LengthUnit};
use stead_format::scalars::words;
use stead_format::shapes::Vector;
use stead_format::surroundings::{PartTable, StockTable};
use stead_format::tool::{CutTable, ToolTable};
use stead_format::units::{Mm, ranges};

ranges! {
    /// A distance of path points. mm
    Step: Included(0.01), Included(1000.0);
    /// A chord error. mm
    Chord: Included(1e-4), Included(10.0);
}

words!(LengthUnit, CamFormat, Machine);

/// Cutting forces from a tool path and the stock that it cuts, for `stead forces`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ForcesFile {
    /// Keys of this file whose values are guesses (`stock.depth_mm`), or whole tables: every result says that it rests
    /// on them.
    pub guesses: Option<Vec<String>>,
    /// The tool path, relative to the folder of this file: CLDATA, G-code, or a task file (CSV), which has no rapid
    /// moves.
    pub path: String,
    /// How a path from CAM is read.
    pub reading: Option<ReadingTable>,
    /// The material before it is cut.
    pub stock: StockTable,
    /// The cutter.
    pub tool: ToolTable,
    /// Speed of the spindle (`spindle_rpm`), where the path does not state it, and `feed_per_tooth_mm` for a path
    /// without feeds.
    pub cut: Option<CutTable>,
    /// The material that is cut, for published coefficients in place of those of `[tool]`.
    pub material: Option<Word<Material>>,
    /// Operations that cut the same stock before, in order; nothing is reported of them.
    pub before: Option<Vec<BeforeTable>>,
    /// The part as it shall be, which must not be cut into.
    pub finished_part: Option<PartTable>,
}

/// How a path from CAM is read: the options of `stead import path`.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct ReadingTable {
    /// Unit of length, where the path does not state it.
    pub units: Option<Word<LengthUnit>>,
    /// What the path is written in; told from the file where left out, and the dialect of `cldata` always.
    pub format: Option<Word<CamFormat>>,
    /// The machine that G-code with rotary axes is for.
    pub machine: Option<Word<Machine>>,
    /// Where the rotary axes meet, for G-code without tool centre point control.
    pub pivot_mm: Option<Vector<Mm>>,
    /// Whether tool centre point control is on though the G-code has no G43.4; false where left out.
    pub tcp: Option<bool>,
    /// Whether the holes of drilling cycles are left out; false where left out.
    pub skip_cycles: Option<bool>,
    /// Whether links between cuts that are programmed at feed are taken as cuts; false where left out, which makes them
    /// rapid moves.
    pub keep_links: Option<bool>,
    /// Words of CLDATA that are passed over whatever they do, or codes of G-code whose blocks are passed over.
    pub ignore: Option<Vec<String>>,
    /// Largest distance between path points; 10 where left out.
    pub step_mm: Option<Mm<Step>>,
    /// How far a point that is left out may be from the line that stands for it; 0.01 where left out.
    pub chord_mm: Option<Mm<Chord>>,
}

/// An operation that is done before.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BeforeTable {
    /// Its tool path, relative to the folder of this file.
    pub path: String,
    /// Its cutter: its shape alone counts.
    pub tool: ToolTable,
    /// How its path is read, where it comes from CAM; as that of this file where left out.
    pub reading: Option<ReadingTable>,
}
