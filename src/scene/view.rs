//! The part of the plane of starts that a picture shows.

use serde::{Deserialize, Serialize};

use super::SceneError;
use crate::physics::{Dd, Scalar, Theta};

/// Smallest width of a view in rad.
pub const LEAST_WIDTH: f64 = 1e-100;

/// A centre, a width, and the way the picture lies on the plane. Coordinates are decimal strings,
/// so that no digit is lost between a file and the arithmetic.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct View {
    /// Centre (θ1, θ2) in rad.
    pub center: [String; 2],
    /// Length of the horizontal axis in rad; pixels are square.
    pub width: String,
    /// Angle by which the picture's horizontal axis is turned anticlockwise, in degrees.
    pub rotate: f64,
    /// Factor by which the vertical axis shows fewer radians than square pixels would.
    pub stretch: f64,
}

impl Default for View {
    fn default() -> Self {
        View {
            center: ["0".to_string(), "0".to_string()],
            width: "6.283185307179586".to_string(),
            rotate: 0.0,
            stretch: 1.0,
        }
    }
}

/// The first characters of a text that may be absurdly long, with an ellipsis for the rest.
fn shortened(text: &str) -> String {
    let mut first: String = text.chars().take(SHOWN).collect();
    if first.len() < text.len() {
        first.push('…');
    }
    first
}

/// Number of characters shown of a refused coordinate.
const SHOWN: usize = 60;

impl View {
    /// Checks that every number can be used.
    pub fn check(&self) -> Result<(), SceneError> {
        for coordinate in &self.center {
            let fine = Theta::parse(coordinate).is_some_and(|x| x.to_f64().abs() <= 1e6);
            let range = "each angle must be a decimal number between -1e6 and 1e6 rad, in at most \
                         1000 characters";
            refuse_unless(fine, "--center", &shortened(coordinate), range)?;
        }
        let width = Dd::parse(&self.width).is_some_and(|w| (LEAST_WIDTH..=1e3).contains(&w.hi));
        let range = "it must be a decimal number between 1e-100 and 1e3 rad";
        refuse_unless(width, "--width", &self.width, range)?;
        let rotate = (-360.0..=360.0).contains(&self.rotate);
        let range = "it must lie between -360 and 360 degrees";
        refuse_unless(rotate, "--rotate", &self.rotate.to_string(), range)?;
        let stretch = (1e-6..=1e6).contains(&self.stretch);
        let range = "it must lie between 1e-6 and 1e6";
        refuse_unless(stretch, "--stretch", &self.stretch.to_string(), range)
    }

    /// The centre in rad; call [`View::check`] first.
    pub fn center_rad(&self) -> [Theta; 2] {
        [0, 1].map(|i| Theta::parse(&self.center[i]).unwrap_or_default())
    }

    /// The width in rad; call [`View::check`] first.
    pub fn width_rad(&self) -> Dd {
        Dd::parse(&self.width).unwrap_or(Dd::TAU)
    }

    /// True if the picture maps onto itself under (θ1, θ2) → (−θ1, −θ2), pixel by pixel.
    pub fn is_symmetric(&self) -> bool {
        self.center_rad().iter().all(|theta| *theta == Theta::ZERO)
    }
}

fn refuse_unless(
    fine: bool,
    option: &'static str,
    value: &str,
    range: &'static str,
) -> Result<(), SceneError> {
    if fine {
        return Ok(());
    }
    Err(SceneError { option, value: format!("'{value}'"), range })
}
