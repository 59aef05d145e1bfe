//! Planning with constraints that are checked only where a plan meets them, for those that are dear to check: a plan is
//! made without them, what breaks one in it is forbidden, and the plan is made again until nothing does.

/// A plan that is made again and again, with more and more of it forbidden.
pub trait Lazy {
    /// The plan.
    type Plan;
    /// The reason why there is none.
    type Refused;

    /// The best plan without what is forbidden.
    ///
    /// # Errors
    /// `Refused` where there is none.
    fn plan(&mut self) -> Result<Self::Plan, Self::Refused>;

    /// Forbids what breaks a constraint in a plan; whether anything does.
    fn forbid(&mut self, plan: &Self::Plan) -> bool;
}

/// The first plan in which nothing had to be forbidden, or the last of so many `rounds`, and whether it is free.
///
/// # Errors
/// `Refused` where nothing is left to plan with.
pub fn until_free<J: Lazy>(job: &mut J, rounds: usize) -> Result<(J::Plan, bool), J::Refused> {
    let mut left = rounds;
    loop {
        let plan = job.plan()?;
        let is_free = !job.forbid(&plan);
        left = left.saturating_sub(1);
        if is_free || left == 0 {
            return Ok((plan, is_free));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The least of some numbers that is even.
    struct LeastEven(Vec<u32>);

    impl Lazy for LeastEven {
        type Plan = u32;
        type Refused = ();

        fn plan(&mut self) -> Result<u32, ()> {
            self.0.iter().copied().min().ok_or(())
        }

        fn forbid(&mut self, plan: &u32) -> bool {
            self.0.retain(|number| number != plan || number % 2 == 0);
            plan % 2 == 1
        }
    }

    #[test]
    fn the_first_plan_in_which_nothing_is_forbidden_is_taken() {
        let run = |numbers: &[u32], rounds: usize| until_free(&mut LeastEven(numbers.to_vec()), rounds);
        assert_eq!(run(&[5, 1, 8, 3, 6], 9), Ok((6, true)));
        assert_eq!(run(&[5, 1, 8, 3, 6], 2), Ok((3, false)));
        assert_eq!(run(&[5, 1, 3], 9), Err(()));
    }
}
