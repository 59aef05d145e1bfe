//! Published cutting coefficients by material.

use stead_format::scalars::words;
use stead_model::cutting::Coefficients;
use stead_numerics::message::Note;

stead_numerics::worded! {
    /// A material with published coefficients.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum Material {
        /// Aluminium 6060-T6.
        Aluminium6060 = "aluminium-6060",
        /// Aluminium 6082-T6.
        Aluminium6082 = "aluminium-6082",
        /// Aluminium 7075-T6.
        Aluminium7075 = "aluminium-7075",
        /// Aluminium 7075, cut with high-speed steel.
        Aluminium7075Hss = "aluminium-7075-hss",
        /// Structural steel St 52-3.
        SteelSt52 = "steel-st52",
    }
}

words!(Material);

const REVIEW: &str = "Milling Force Model for Aviation Aluminum Alloy, Chinese Journal of Mechanical Engineering 34 (2021), doi \
     10.1186/s10033-021-00536-9, table 5, cemented carbide, dry";
const REVIEW_HSS: &str = "Milling Force Model for Aviation Aluminum Alloy, Chinese Journal of Mechanical Engineering 34 (2021), doi \
     10.1186/s10033-021-00536-9, table 5, high-speed steel, dry";
const UMONS: &str = "the UMONS work on robotic milling, which states neither edge nor axial coefficients";

impl Material {
    /// K_t, K_r and K_a (MPa), K_te and K_re (N/mm), and where they are printed.
    fn published(self) -> ([f64; 3], [f64; 2], &'static str) {
        match self {
            Self::Aluminium6060 => ([661.553, 253.458, 0.0], [0.0, 0.0], UMONS),
            // The axial edge coefficients of the review, 0.7 and 2.8 N/mm, have no place in the force law.
            Self::Aluminium6082 => ([631.0, 99.0, 273.0], [13.0, 10.0], REVIEW),
            Self::Aluminium7075 => ([767.01, 168.8, 222.0], [27.7, 26.6], REVIEW),
            // The axial edge coefficient, 1.105 N/mm, has no place either.
            Self::Aluminium7075Hss => ([951.365, 262.597, 323.33], [11.115, 11.314], REVIEW_HSS),
            Self::SteelSt52 => ([3333.0, 2289.0, 0.0], [0.0, 0.0], UMONS),
        }
    }

    /// Its coefficients.
    pub fn coefficients(self) -> Coefficients {
        let ([tangential, radial, axial], [tangential_edge, radial_edge], _) = self.published();
        Coefficients {
            tangential: tangential * 1e6,
            radial: radial * 1e6,
            axial: axial * 1e6,
            tangential_edge: tangential_edge * 1e3,
            radial_edge: radial_edge * 1e3,
        }
    }

    /// That the coefficients are not those of the user's cutter, and whose they are.
    pub fn note(self) -> Note {
        let ([kt, kr, ka], [kte, kre], source) = self.published();
        let name = self.word();
        let text = format!(
            "the cutting coefficients are published ones for {name} with another cutter (K_t {kt}, K_r {kr}, K_a {ka} MPa, K_te {kte}, K_re \
             {kre} N/mm; {source}): measure your own"
        );
        Note::rests_on(format!("coefficients published for {name}"), text)
    }
}
