//! Positions of G-code: where a block leads to, and holes that are left out.

use super::super::super::LARGEST;
use super::super::block::{Block, Motion, Word};
use super::super::state::State;
use super::{CYCLES, LARGEST_ANGLE, Reader};
use nalgebra::Vector3;
use stead_disk::input::InputError;

impl Reader<'_> {
    /// Takes a hole of a canned cycle, which is left out; how deep the tool is then is not known.
    pub(super) fn leave_out_hole(&mut self, block: &Block<'_>, metres: f64) -> Result<(), InputError> {
        let words: Vec<Word> = block.words.iter().copied().filter(|(letter, _)| "XYABC".contains(*letter)).collect();
        let has_cycle = block.words.iter().any(|word| word.0 == 'G' && CYCLES.contains(&(word.1 as i64)));
        let mut at = self.target(&Block { words: &words, ..*block }, metres)?;
        if !words.is_empty() || has_cycle {
            let place = at.position.map(|value| value.unwrap_or(0.0));
            self.program.holes_left_out.push((Vector3::from(place), block.line));
        }
        at.position[2] = None;
        self.state = at;
        Ok(())
    }

    /// Takes a move with the tool turned whose tip is not known: a rapid one leaves the tool at a place that is not
    /// known.
    pub(super) fn turn_without_control(
        &mut self,
        block: &Block<'_>,
        motion: Motion,
        end: State,
    ) -> Result<(), InputError> {
        if motion != Motion::Rapid {
            let word = block.words.iter().find(|(letter, _)| "ABC".contains(*letter));
            let word = word.or_else(|| block.words.iter().find(|(letter, _)| "XYZ".contains(*letter)));
            let allowed = "G43.4 before, --tcp where it is on all the same, or --pivot-mm X,Y,Z of the machine";
            let problem = "a rotary axis without tool centre point control";
            return Err(self.fail(block.line, word.copied().unwrap_or(('G', 1.0)), problem, allowed));
        }
        self.program
            .note("rapid moves of a turned tool without tool centre point control: where it is then is not known here");
        self.state = State { position: [None; 3], ..end };
        Ok(())
    }

    /// Where a block leads to.
    pub(super) fn target(&mut self, block: &Block<'_>, metres: f64) -> Result<State, InputError> {
        let mut end = self.state;
        for (axis, letter) in ['X', 'Y', 'Z'].into_iter().enumerate() {
            let Some(value) = block.get(letter) else { continue };
            if value.abs() * metres > LARGEST {
                return Err(self.fail(block.line, (letter, value), "not a position of a usual size", "up to 100 m"));
            }
            end.position[axis] = match (self.modes.is_incremental, self.state.position[axis]) {
                (false, _) => Some(value * metres),
                (true, Some(before)) => Some(before + value * metres),
                (true, None) => {
                    let allowed = "a position with G90 before";
                    return Err(self.fail(
                        block.line,
                        (letter, value),
                        "G91 from where the tool is not known",
                        allowed,
                    ));
                }
            };
        }
        for (axis, letter) in ['A', 'B', 'C'].into_iter().enumerate() {
            let Some(value) = block.get(letter) else { continue };
            let word = (letter, value);
            if value.abs() > LARGEST_ANGLE {
                return Err(self.fail(block.line, word, "not an angle of a usual size", "up to 36000 deg"));
            }
            let before = if self.modes.is_incremental { self.state.angles[axis] } else { 0.0 };
            end.angles[axis] = before + value.to_radians();
            match self.settings.machine {
                Some(machine) if machine.has(axis) => {}
                Some(machine) => {
                    let problem = format!("not a rotary axis of {}", machine.word());
                    return Err(self.fail(block.line, word, &problem, "another --machine"));
                }
                None if end.angles[axis] == 0.0 => continue,
                None => {
                    let allowed = "--machine table-ac, table-bc, head-ac or head-bc";
                    return Err(self.fail(block.line, word, "a rotary axis of a machine that is not named", allowed));
                }
            }
        }
        Ok(end)
    }
}
