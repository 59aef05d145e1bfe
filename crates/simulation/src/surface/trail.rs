//! Trajectory of the tool centre, from which the cut surface follows.

/// The tool centre at the end of a step, in the plane of the cut: x along the feed, y along the wall's outward normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Node {
    /// Where it is. m
    pub place: [f64; 2],
    /// How far it would come in one step. m
    pub motion: [f64; 2],
}

/// Bounds of the trajectory up to a node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extent {
    /// At least the largest x so far. m
    pub front: f64,
    /// At most the smallest y so far. m
    pub bottom: f64,
    /// At least the largest y so far. m
    pub top: f64,
}

impl Extent {
    /// Bounds of both.
    #[must_use]
    pub fn joined(self, other: Self) -> Self {
        let Self { front, bottom, top } = self;
        Self { front: front.max(other.front), bottom: bottom.min(other.bottom), top: top.max(other.top) }
    }
}

/// Bounds of the trajectory up to a node, in two parts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extents {
    /// Over the last one to two stretches.
    pub recent: Extent,
    /// Of all before that; none at the beginning.
    pub before: Option<Extent>,
}

/// A step: the cubic `place + s (motion + s (second + s third))` for s from 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Leg {
    place: [f64; 2],
    motion: [f64; 2],
    second: [f64; 2],
    third: [f64; 2],
}

/// The trajectory of the tool centre, one node a step; between nodes a cubic through places and motions (Hermite).
#[derive(Debug, Clone, PartialEq)]
pub struct Trail {
    /// Nodes in a stretch.
    stretch: usize,
    nodes: Vec<Node>,
    legs: Vec<Leg>,
    extents: Vec<Extent>,
    /// For each node: since the beginning of the stretch before its own.
    recents: Vec<Extent>,
    /// Of each stretch by itself.
    stretches: Vec<Extent>,
}

impl Trail {
    /// An empty trail with room for a number of steps. What is long past is bounded apart from the last one to two
    /// stretches of at least one step: a tool that vibrates should come farther in a stretch than it vibrates.
    pub fn with_room(steps: usize, stretch: usize) -> Self {
        let stretch = stretch.max(1);
        Self {
            stretch,
            nodes: Vec::with_capacity(steps),
            legs: Vec::with_capacity(steps),
            extents: Vec::with_capacity(steps),
            recents: Vec::with_capacity(steps),
            stretches: Vec::with_capacity(steps / stretch + 1),
        }
    }

    /// The end of the next step; the first node is that of step 0.
    pub fn push(&mut self, node: Node) {
        let at = |[x, y]: [f64; 2]| Extent { front: x, bottom: y, top: y };
        let mut own = at(node.place);
        if let Some(last) = self.nodes.last() {
            // A cubic stays within its control points.
            for (place, motion) in [(last.place, last.motion), (node.place, node.motion.map(|motion| -motion))] {
                own = own.joined(at([0, 1].map(|axis| place[axis] + motion[axis] / 3.0)));
            }
            let part = |axis: usize| {
                let leap = node.place[axis] - last.place[axis];
                let (start, end) = (last.motion[axis], node.motion[axis]);
                (3.0 * leap - 2.0 * start - end, start + end - 2.0 * leap)
            };
            let ((second_x, third_x), (second_y, third_y)) = (part(0), part(1));
            let (second, third) = ([second_x, second_y], [third_x, third_y]);
            self.legs.push(Leg { place: last.place, motion: last.motion, second, third });
        }
        self.extents.push(self.extents.last().map_or(own, |all| all.joined(own)));
        match self.stretches.last_mut().filter(|_| !self.nodes.len().is_multiple_of(self.stretch)) {
            Some(stretch) => *stretch = stretch.joined(own),
            None => self.stretches.push(own),
        }
        let recent = self.stretches.iter().rev().take(2).copied().reduce(Extent::joined);
        self.recents.extend(recent);
        self.nodes.push(node);
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
    pub fn up_to(&self, time: f64) -> Option<Extents> {
        if time < 0.0 || time.is_nan() {
            return None;
        }
        let index = (time as i64 as usize + 1).min(self.nodes.len().wrapping_sub(1));
        let recent = *self.recents.get(index)?;
        let stretch = index / self.stretch;
        let before = if stretch < 2 { None } else { self.extents.get((stretch - 1) * self.stretch).copied() };
        Some(Extents { recent, before })
    }

    /// Place and motion at a time, in steps; `None` before the first node. After the last the cubic of the last step
    /// goes on.
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
