//! The tool in the spindle: how it is called, how it turns, and what comments say of it.

use super::super::super::tool::ProgramTool;
use super::super::block::Block;
use super::Reader;

impl Reader<'_> {
    /// Takes what a block says of the tool in the spindle: `T`, `M6`, `S`, `M3` and `M4`.
    pub(super) fn change_tool(&mut self, block: &Block<'_>) {
        if let Some(tool) = block.get('T') {
            self.course.program.name_tool(format!("T{tool}"));
            self.called = Some(tool.clamp(0.0, 1e9) as u32);
        }
        let has = |number: f64| block.words.contains(&('M', number));
        let is_changed = has(6.0) || (block.get('T').is_some() && self.course.program.tools.len() == 1);
        let (number, speed) = (self.called.filter(|_| is_changed), block.get('S'));
        let speed = speed.filter(|speed| *speed > 0.0 && speed.is_finite()).map(|speed| speed / 60.0);
        if number.is_none() && speed.is_none() && !has(3.0) && !has(4.0) {
            return;
        }
        self.course.program.change_tool(|tool| {
            tool.number = number.or(tool.number);
            tool.spindle_speed = speed.or(tool.spindle_speed);
            tool.is_counterclockwise = has(4.0) || (tool.is_counterclockwise && !has(3.0));
        });
    }

    /// Gives the tools of the program what comments say of them.
    pub(super) fn describe_tools(&mut self) {
        let metres = self.metres();
        // A comment without a number is of the tool where there is but one.
        let is_one = self.course.program.tools.len() <= 1 && self.described.len() == 1;
        if self.course.program.tools_from.is_empty() {
            self.course.program.tools_from.push((0, ProgramTool::default()));
        }
        for (_, tool) in &mut self.course.program.tools_from {
            let known = self.described.iter().find(|known| tool.number.is_some() && known.number == tool.number);
            let is_its = |known: &&ProgramTool| is_one && (known.number.is_none() || tool.number.is_none());
            let known = known.or_else(|| self.described.first().filter(is_its));
            if let Some(known) = known {
                let [diameter, corner_radius] =
                    [known.diameter, known.corner_radius].map(|length| length.map(|length| length * metres));
                *tool = ProgramTool { number: tool.number, diameter, corner_radius, ..known.clone().turning_as(tool) };
            } else if let Some(number) = tool.number {
                tool.description = format!("T{number}");
            }
        }
    }
}
