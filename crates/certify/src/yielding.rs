//! How the arm yields at a place, and the matrices that weigh it, both symmetric.

/// The compliance at a point, symmetric, in the frame of a load: [[m + d0, d1, v0], [d1, m - d0, v1], [v0, v1, zz]].
/// m/N
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Yielding {
    pub m: f64,
    pub d: [f64; 2],
    pub v: [f64; 2],
    pub zz: f64,
}

/// A symmetric matrix S in the frame of a load: the score of a state is at least `<C, S>`. N
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Tangent {
    /// S11 + S22.
    pub plane: f64,
    /// S11 - S22 and 2 S12.
    pub turning: [f64; 2],
    /// 2 S13 and 2 S23.
    pub vertical: [f64; 2],
    /// S33.
    pub axial: f64,
    /// W^T u, by which the displacement under a moment counts.
    pub along: [f64; 3],
}

impl Yielding {
    /// Of a symmetric matrix.
    pub fn of(matrix: [[f64; 3]; 3]) -> Self {
        let [x, y, z] = matrix;
        let v = [0.5 * (x[2] + z[0]), 0.5 * (y[2] + z[1])];
        Self { m: 0.5 * (x[0] + y[1]), d: [0.5 * (x[0] - y[1]), 0.5 * (x[1] + y[0])], v, zz: z[2] }
    }

    /// In a frame turned by an angle about axis 1. rad
    pub fn turned(&self, angle: f64) -> Self {
        let ((s, c), (s2, c2)) = (libm::sincos(angle), libm::sincos(2.0 * angle));
        let ([d0, d1], [v0, v1]) = (self.d, self.v);
        Self { d: [d0 * c2 + d1 * s2, d1 * c2 - d0 * s2], v: [v0 * c + v1 * s, v1 * c - v0 * s], ..*self }
    }

    /// A unit vector near to the direction in which it yields most.
    pub fn softest(&self) -> [f64; 3] {
        let Self { m, d, v, zz } = self;
        let columns = [[m + d[0], d[1], v[0]], [d[1], m - d[0], v[1]], [v[0], v[1], *zz]];
        let longest = columns.into_iter().fold(columns[0], |a, b| if dot(b, b) > dot(a, a) { b } else { a });
        let size = 1.0 / norm(longest).max(f64::MIN_POSITIVE);
        let next = self.times(self.times(self.times(scaled(longest, size))));
        scaled(next, 1.0 / norm(next).max(f64::MIN_POSITIVE))
    }

    /// The root of the sum of the squares of its entries, which its norm does not exceed. m/N
    pub fn size(&self) -> f64 {
        let Self { m, d, v, zz } = self;
        let square = 2.0 * (m * m + d[0] * d[0] + d[1] * d[1] + v[0] * v[0] + v[1] * v[1]) + zz * zz;
        libm::sqrt(square)
    }

    /// How far another one is from it. m/N
    pub fn apart(&self, o: &Self) -> f64 {
        let off = |a: [f64; 2], b: [f64; 2]| [a[0] - b[0], a[1] - b[1]];
        Self { m: self.m - o.m, d: off(self.d, o.d), v: off(self.v, o.v), zz: self.zz - o.zz }.size()
    }

    /// The sum of two.
    #[inline(always)]
    pub fn plus(&self, other: &Self) -> Self {
        let sum = |a: [f64; 2], b: [f64; 2]| [a[0] + b[0], a[1] + b[1]];
        Self { m: self.m + other.m, d: sum(self.d, other.d), v: sum(self.v, other.v), zz: self.zz + other.zz }
    }

    /// The displacement under a force.
    #[inline(always)]
    pub fn times(&self, force: [f64; 3]) -> [f64; 3] {
        let (Self { m, d, v, zz }, [x, y, z]) = (self, force);
        [(m + d[0]) * x + d[1] * y + v[0] * z, d[1] * x + (m - d[0]) * y + v[1] * z, v[0] * x + v[1] * y + zz * z]
    }
}

impl Tangent {
    /// Of `W^T u` and `f + e`.
    #[inline(always)]
    pub fn new(a: [f64; 3], g: [f64; 3]) -> Self {
        Self {
            plane: a[0] * g[0] + a[1] * g[1],
            turning: [a[0] * g[0] - a[1] * g[1], a[0] * g[1] + a[1] * g[0]],
            vertical: [a[0] * g[2] + a[2] * g[0], a[1] * g[2] + a[2] * g[1]],
            axial: a[2] * g[2],
            along: a,
        }
    }

    pub fn plus(&self, other: &Self) -> Self {
        let sum = |a: [f64; 2], b: [f64; 2]| [a[0] + b[0], a[1] + b[1]];
        Self {
            plane: self.plane + other.plane,
            turning: sum(self.turning, other.turning),
            vertical: sum(self.vertical, other.vertical),
            axial: self.axial + other.axial,
            along: added(self.along, other.along),
        }
    }

    /// The same by a factor.
    #[inline(always)]
    pub fn times(&self, factor: f64) -> Self {
        let by = |pair: [f64; 2]| pair.map(|x| x * factor);
        Self {
            plane: self.plane * factor,
            turning: by(self.turning),
            vertical: by(self.vertical),
            axial: self.axial * factor,
            along: self.along.map(|x| x * factor),
        }
    }

    /// `<C, S>`, and what the displacement under a moment adds.
    #[inline(always)]
    pub fn with(&self, c: &Yielding, by_moment: [f64; 3]) -> f64 {
        self.of(c) + dot(self.along, by_moment)
    }

    /// `<C, S>`.
    #[inline(always)]
    pub fn of(&self, c: &Yielding) -> f64 {
        c.m * self.plane
            + c.d[0] * self.turning[0]
            + c.d[1] * self.turning[1]
            + c.v[0] * self.vertical[0]
            + c.v[1] * self.vertical[1]
            + c.zz * self.axial
    }
}

#[inline(always)]
pub(super) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
pub(super) fn norm(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

#[inline(always)]
pub(super) fn added(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
pub(super) fn scaled(a: [f64; 3], factor: f64) -> [f64; 3] {
    a.map(|x| x * factor)
}
