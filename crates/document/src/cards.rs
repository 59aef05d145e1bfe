//! Cards of a page as data: tables and charts.

mod chart;
mod table;

pub use chart::{Axis, Chart, HeatMap, MapLine, MapPoint, Mark, Outline, Polar, PolarChoice, Series, Style};
pub use table::{Cell, Column, Table};
