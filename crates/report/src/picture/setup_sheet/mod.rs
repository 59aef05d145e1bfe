//! The setup sheet: one A4 page in black on white for whoever sets a placement up.
//!
//! A pixel is a quarter of a millimetre of the paper. What is written is what `setup_sheet` of the document states,
//! rounded to a tenth of a millimetre and a hundredth of a degree.

mod rows;
mod views;
mod words;

use super::canvas::{Canvas, Pixel, TextStyle, paper};
use super::colour::{BLACK, PALE};
use crate::placement::SummaryLine;
use crate::units::lines_of;
use stead_disk::input::InputFile;
use stead_placement::outcome::Case;
use stead_placement::setup_sheet::{SetupSheet, SheetFrame};
use stead_problem::problem::Problem;
use words::shortened;

/// What stands in the title block beside the robot.
#[derive(Debug, Clone, Copy)]
pub struct SheetTitle<'a> {
    /// The files that the run depends on.
    pub inputs: &'a [InputFile],
    /// Seed of its random numbers.
    pub seed: u64,
    /// What is cut, what the result rests on, what was not checked and what looks wrong.
    pub said: &'a [SummaryLine],
}

/// The left and the right edge of what is written.
const SIDES: [i32; 2] = [44, 796];
/// The lower edge.
const BOTTOM: i32 = 1146;
/// From line to line of a table.
const LINE: i32 = 16;
/// Letters of a line of small print, and of one beside its heading: with the widest letters that a viewer may take.
const WIDEST: usize = 140;
const LETTERS: usize = 120;
/// Letters of tables and of small print.
const SIZES: [f64; 2] = [11.5, 9.5];

/// The sheet of a case.
pub fn setup_sheet(problem: &Problem, case: &Case, sheet: &SetupSheet, title: &SheetTitle<'_>) -> String {
    let problem = &*problem.in_setup(&case.setup);
    paper(|canvas| {
        let [left, right] = SIDES;
        let run = title.inputs.iter().find(|input| input.role == "config").map_or("run", |input| &input.name);
        canvas.text("Setup sheet", (left, 54), TextStyle::new(21.0).bold());
        canvas.text(run, (left + 150, 55), TextStyle::new(15.0));
        canvas.text("Date, name:", (right - 250, 55), TextStyle::new(SIZES[0]));
        canvas.line(&[(right - 175, 62), (right, 62)], BLACK, 1);
        canvas.text(&frame_words(sheet), (left, 80), TextStyle::new(SIZES[0]));
        // The views have the height that tables and title block leave.
        let mut below = 0;
        paper(|scratch| below = tables(scratch, case, sheet, 0));
        let top = BOTTOM - title_height(title);
        let height = (top - below - VIEWS - UNDER_VIEWS).clamp(LEAST_VIEW, MOST_VIEW);
        views::draw(canvas, problem, case, sheet, (VIEWS, height));
        let end = tables(canvas, case, sheet, VIEWS + height + UNDER_VIEWS);
        title_block(canvas, problem, title, end.max(top));
    })
}

/// The upper edge of the views, what is between them and the tables, and the least and the largest height of a view.
const VIEWS: i32 = 98;
const UNDER_VIEWS: i32 = 42;
const LEAST_VIEW: i32 = 180;
const MOST_VIEW: i32 = 388;

/// The tables from a height on; returns where they end.
fn tables(canvas: &mut Canvas, case: &Case, sheet: &SetupSheet, y: i32) -> i32 {
    let mut table = Table { canvas, y };
    rows::places(&mut table, sheet);
    rows::checks(&mut table, sheet);
    rows::tolerances(&mut table, sheet);
    rows::limits(&mut table, case, sheet);
    table.y
}

/// The height of the title block with all of its lines.
fn title_height(title: &SheetTitle<'_>) -> i32 {
    12 * (title.inputs.len() + said(title).len()) as i32 + 30
}

/// What is to be known of the result, in lines with what they are about.
fn said<'a>(title: &SheetTitle<'a>) -> Vec<(&'a str, String)> {
    let lines = title.said.iter().flat_map(|line| {
        let abouts = std::iter::once(line.about).chain(std::iter::repeat(""));
        abouts.zip(lines_of(&line.text, LETTERS))
    });
    lines.collect()
}

/// Which frame the places are in.
fn frame_words(sheet: &SetupSheet) -> String {
    let frame = match sheet.frame {
        SheetFrame::Root => "the robot root frame of the controller, as the pendant shows it",
        SheetFrame::Base => {
            if sheet.is_root {
                "the base frame of the robot file's rows (the controller's root frame is at a slant to it)"
            } else {
                "the base frame of the robot file's rows (no [root] is known: the pendant may show another frame)"
            }
        }
        SheetFrame::Cell => "the cell frame, in which the run file states the mount and the external axes",
    };
    format!("Places in mm, in {frame}. Angles in deg.")
}

/// Run, robot, version and digests, in a frame at the foot of the page, and what is to be known of the result.
fn title_block(canvas: &mut Canvas, problem: &Problem, title: &SheetTitle<'_>, top: i32) {
    let [left, right] = SIDES;
    let mut said = said(title);
    // A sheet without room for all of it says where the rest is.
    let room = ((BOTTOM - top - 30) / 12 - title.inputs.len() as i32).max(1) as usize;
    if said.len() > room {
        said.truncate(room - 1);
        said.push(("", "and more: see notes.txt beside this sheet".to_owned()));
    }
    canvas.outline((left, top), (right, BOTTOM), BLACK);
    let small = TextStyle::new(SIZES[1]);
    let version = format!("stead {}, seed {}", env!("CARGO_PKG_VERSION"), title.seed);
    canvas.text(&shortened(problem.robot.name(), 50), (left + 8, top + 13), TextStyle::new(SIZES[0]).bold());
    canvas.text(&version, (left + 370, top + 13), TextStyle::new(SIZES[0]));
    canvas.text("valid for these files alone (SHA-256):", (right - 8, top + 13), small.ending());
    for ((about, text), line) in said.iter().zip(0..) {
        let y = top + 30 + 12 * line;
        canvas.text(about, (left + 8, y), small.bold());
        canvas.text(text, (left + 96, y), small);
    }
    for (input, line) in title.inputs.iter().zip(said.len() as i32..) {
        let y = top + 30 + 12 * line;
        canvas.text(input.role, (left + 8, y), small);
        canvas.text(&shortened(&input.name, 52), (left + 80, y), small);
        canvas.text(&input.sha256, (right - 8, y), TextStyle::new(8.5).ending());
    }
}

/// Lines of cells, from above.
struct Table<'a> {
    canvas: &'a mut Canvas,
    y: i32,
}

impl Table<'_> {
    /// A heading with a rule below it.
    fn heading(&mut self, text: &str) {
        self.y += 8;
        self.canvas.text(text, (SIDES[0], self.y), TextStyle::new(12.5).bold());
        self.y += 9;
        self.canvas.line(&[(SIDES[0], self.y), (SIDES[1], self.y)], BLACK, 1);
        self.y += 10;
    }

    /// Cells that start at, or for a negative number end at, so many pixels from the left edge.
    fn row<'c>(&mut self, cells: impl IntoIterator<Item = (i32, &'c str)>, is_bold: bool) {
        for (at, text) in cells {
            let style = TextStyle::new(SIZES[0]);
            let style = if at < 0 { style.ending() } else { style };
            let style = if is_bold { style.bold() } else { style };
            self.canvas.text(text, (SIDES[0] + at.abs(), self.y), style);
        }
        self.y += LINE;
    }

    /// Small print, in as many lines as it takes.
    fn remark(&mut self, text: &str) {
        self.small(text, TextStyle::new(SIZES[1]));
    }

    /// The same, to be seen first.
    fn warn(&mut self, text: &str) {
        self.small(text, TextStyle::new(SIZES[1]).bold());
    }

    fn small(&mut self, text: &str, style: TextStyle) {
        for line in lines_of(text, WIDEST) {
            self.canvas.text(&line, (SIDES[0], self.y - 2), style);
            self.y += 12;
        }
    }

    /// A thin line between rows.
    fn rule(&mut self) {
        let y = self.y - LINE / 2;
        let at = |x: i32| -> Pixel { (x, y) };
        self.canvas.line(&[at(SIDES[0]), at(SIDES[1])], PALE, 1);
    }
}
