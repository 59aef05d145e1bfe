//! Which postures segments may be driven in, what the moves between them count, and how one plan is taken of several
//! that are as good.

use stead_model::robot::{Posture, PostureClass};

/// Rules for the postures of segments and the moves between them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PostureRules {
    /// Whether each posture is allowed, in the order of their numbers.
    pub allowed: [bool; 8],
    /// Whether the posture may change from one segment to the next.
    pub may_change: bool,
    /// What the moves between segments count in the choice of postures and turns, beside the objective, for each second
    /// that their slowest joint needs at full speed. m/s
    pub move_weight: f64,
    /// How much worse (relative) than its best plan the plan of a segment may be to make the moves between segments
    /// shorter.
    pub tie: f64,
}

impl Default for PostureRules {
    /// Every posture, changes at will, and plans up to 0.1 % worse than the best where that makes the moves shorter.
    fn default() -> Self {
        Self { tie: 1e-3, ..Self::NONE }
    }
}

impl PostureRules {
    /// No rules: every posture, changes at will, and always the best plan.
    pub const NONE: Self = Self { allowed: [true; 8], may_change: true, move_weight: 0.0, tie: 0.0 };

    /// Whether a posture is allowed.
    pub fn allows(&self, posture: Posture) -> bool {
        self.allowed[usize::from(posture.number()) - 1]
    }

    /// Whether a posture of a class is allowed.
    pub fn allows_class(&self, class: PostureClass) -> bool {
        class.postures().into_iter().any(|posture| self.allows(posture))
    }

    /// The allowed postures.
    pub fn allowed(&self) -> impl Iterator<Item = Posture> + use<> {
        let rules = *self;
        Posture::ALL.into_iter().filter(move |posture| rules.allows(*posture))
    }

    /// Whether the best plan of a segment is always taken.
    pub fn takes_the_best(&self) -> bool {
        self.move_weight == 0.0 && self.tie == 0.0
    }
}
