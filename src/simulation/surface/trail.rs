//! Where the tool centre has been: the only memory of the work that is needed.

/// The tool centre at the end of a step, in the plane of the cut: x along the feed, y along the wall's outward normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Node {
    /// Where it is. m
    pub place: [f64; 2],
    /// How far it would come in one step. m
    pub motion: [f64; 2],
}

/// What all of the way up to a node has in common: bounds of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extent {
    /// At least the largest x so far. m
    pub front: f64,
    /// At most the smallest y so far. m
    pub bottom: f64,
    /// At least the largest y so far. m
    pub top: f64,
}

/// A step: the cubic `place + s (motion + s (second + s third))` for s from 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Leg {
    place: [f64; 2],
    motion: [f64; 2],
    second: [f64; 2],
    third: [f64; 2],
}

/// The way of the tool centre, one node a step; between nodes a cubic through places and motions (Hermite).
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Trail {
    nodes: Vec<Node>,
    legs: Vec<Leg>,
    extents: Vec<Extent>,
}

impl Trail {
    /// An empty trail with room for a number of steps.
    pub fn with_room(steps: usize) -> Self {
        Self { nodes: Vec::with_capacity(steps), legs: Vec::with_capacity(steps), extents: Vec::with_capacity(steps) }
    }

    /// The end of the next step; the first node is that of step 0.
    pub fn push(&mut self, node: Node) {
        let [x, y] = node.place;
        let mut extent = match self.extents.last() {
            None => Extent { front: x, bottom: y, top: y },
            Some(last) => Extent { front: last.front.max(x), bottom: last.bottom.min(y), top: last.top.max(y) },
        };
        if let Some(last) = self.nodes.last() {
            // A cubic stays within its control points.
            for (place, motion) in [(last.place, last.motion), (node.place, node.motion.map(|motion| -motion))] {
                let [x, y] = [0, 1].map(|axis| place[axis] + motion[axis] / 3.0);
                extent.front = extent.front.max(x);
                extent.bottom = extent.bottom.min(y);
                extent.top = extent.top.max(y);
            }
        }
        if let Some(last) = self.nodes.last() {
            let part = |axis: usize| {
                let leap = node.place[axis] - last.place[axis];
                let (start, end) = (last.motion[axis], node.motion[axis]);
                (3.0 * leap - 2.0 * start - end, start + end - 2.0 * leap)
            };
            let ((second_x, third_x), (second_y, third_y)) = (part(0), part(1));
            let (second, third) = ([second_x, second_y], [third_x, third_y]);
            self.legs.push(Leg { place: last.place, motion: last.motion, second, third });
        }
        self.nodes.push(node);
        self.extents.push(extent);
    }

    /// All nodes.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// For each node what it has in common with all before.
    pub fn extents(&self) -> &[Extent] {
        &self.extents
    }

    /// What the nodes up to a time (in steps) and the next one have in common; `None` before the first.
    #[inline]
    pub fn extent(&self, time: f64) -> Option<Extent> {
        if time >= 0.0 { self.extents.get(time as usize + 1).or(self.extents.last()).copied() } else { None }
    }

    /// Place and motion at a time, in steps; `None` before the first node. After the last the cubic of the last step goes on.
    #[inline]
    pub fn at(&self, time: f64) -> Option<Node> {
        let (leg, s) = self.leg(time)?;
        let part = |axis: usize| {
            let (start, second, third) = (leg.motion[axis], leg.second[axis], leg.third[axis]);
            start + s * (2.0 * second + 3.0 * s * third)
        };
        Some(Node { place: leg.at(s), motion: [part(0), part(1)] })
    }

    /// The place at a time, as [`Trail::at`].
    #[inline]
    pub fn place(&self, time: f64) -> Option<[f64; 2]> {
        let (leg, s) = self.leg(time)?;
        Some(leg.at(s))
    }

    /// The step in which a time lies and how far it is into it; the last step for what comes after it.
    #[inline]
    pub(super) fn leg(&self, time: f64) -> Option<(&Leg, f64)> {
        if time < 0.0 || time.is_nan() {
            return None;
        }
        // A signed integer is converted with one instruction.
        let index = (time as i64 as usize).min(self.legs.len().wrapping_sub(1));
        self.legs.get(index).map(|leg| (leg, time - index as i64 as f64))
    }
}

impl Leg {
    /// The coefficients of one coordinate, 0 for x and 1 for y.
    #[inline(always)]
    pub(super) fn parts(&self, axis: usize) -> [f64; 4] {
        [self.place[axis], self.motion[axis], self.second[axis], self.third[axis]]
    }

    #[inline(always)]
    fn at(&self, s: f64) -> [f64; 2] {
        [0, 1].map(|axis| {
            let [place, motion, second, third] = self.parts(axis);
            place + s * (motion + s * (second + s * third))
        })
    }
}
