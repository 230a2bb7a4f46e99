//! The part of the plane of starts that a picture shows.

use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};

use super::allowed::between;
use super::number_in_file::{coordinate, coordinates};
use super::pasted::plain_numbers;
use super::{Axis, BuiltIn, Plane, PlaneKind, SceneError, Setting};
use flipmap_numbers::{Dd, Exact, Scalar};

/// Smallest width of a view, in the unit of the horizontal axis.
pub const MIN_WIDTH: f64 = 1e-100;

/// Largest deviation from π at which a centre counts as π, as a share of the view's width.
const MAX_PI_ERROR: f64 = 1e-15;

/// A centre, a width, a rotation and a stretch. Coordinates are decimal strings, so that no digit
/// is lost between a file and the arithmetic.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct View {
    /// Centre in the units of the plane's axes: (θ1, θ2) in rad on the default plane.
    #[serde(deserialize_with = "coordinates")]
    pub center: [String; 2],
    /// Length of the horizontal axis in its unit; pixels are square.
    #[serde(deserialize_with = "coordinate")]
    pub width: String,
    /// Angle by which the picture's horizontal axis is turned anticlockwise, in degrees.
    pub rotate: f64,
    /// Vertical magnification relative to square pixels.
    pub stretch: f64,
    /// True if both axes span at least `width` in pictures of any shape.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub fit: bool,
}

impl Default for View {
    fn default() -> Self {
        View {
            center: ["0".to_string(), "0".to_string()],
            width: "6.283185307179586".to_string(),
            rotate: 0.0,
            stretch: 1.0,
            fit: false,
        }
    }
}

/// Returns the first [`SHOWN`] characters of a text, with an ellipsis if there are more.
fn shortened(text: &str) -> String {
    let mut first: String = text.chars().take(SHOWN).collect();
    if first.len() < text.len() {
        first.push('…');
    }
    first
}

/// Number of characters of a refused coordinate that are shown.
const SHOWN: usize = 60;

impl View {
    /// The settings that make a view.
    pub const SETTINGS: [Setting; 4] =
        [Setting::Center, Setting::Width, Setting::Rotate, Setting::Stretch];

    /// Returns the view with its coordinates as decimal numbers in the units of these axes: a file
    /// may have them as a person writes them.
    #[must_use]
    pub(super) fn in_units(self, axes: [Axis; 2]) -> Self {
        let plain = |axis: Axis, text: &String| axis.in_unit(&plain_numbers(text));
        let center = [0, 1].map(|i| plain(axes[i], &self.center[i]));
        let width = plain(axes[0], &self.width);
        View { center, width, ..self }
    }

    /// Range of a coordinate of the centre, in the unit of its axis.
    const COORDINATES: RangeInclusive<f64> = -1e6..=1e6;
    /// Largest width of a view, in the unit of the horizontal axis.
    pub(crate) const MAX_WIDTH: f64 = 1e3;
    /// Range of the rotation in degrees.
    pub(crate) const ROTATIONS_DEG: RangeInclusive<f64> = -360.0..=360.0;
    /// Range of the stretch.
    pub(crate) const STRETCHES: RangeInclusive<f64> = 1e-6..=1e6;

    /// Returns the first view of a plane: the home scene's view for the plane of angles, and the
    /// default view for any other.
    pub fn home_of(plane: &Plane) -> Self {
        match plane.kind {
            PlaneKind::ANGLES => BuiltIn::home().document().view,
            _ => View::default(),
        }
    }

    /// Checks that every number can be used on a plane with these axes.
    pub fn check(&self, axes: [Axis; 2]) -> Result<(), SceneError> {
        for (coordinate, axis) in self.center.iter().zip(axes) {
            let x = Exact::parse(coordinate).map(|x| x.to_f64());
            if !x.is_some_and(|x| Self::COORDINATES.contains(&x)) {
                let allowed = format!(
                    "each coordinate must be a decimal number {} {}, in at most 1000 characters",
                    between(&Self::COORDINATES),
                    axis.unit()
                );
                let value = format!("'{}'", shortened(coordinate));
                let error = SceneError::new(Setting::Center.name(), value, allowed);
                return Err(error.hinting(coordinate, 1));
            }
        }
        let widths = MIN_WIDTH..=Self::MAX_WIDTH;
        if !Dd::parse(&self.width).is_some_and(|width| widths.contains(&width.hi)) {
            let error = Setting::Width.refused(axes, format!("'{}'", self.width));
            return Err(error.hinting(&self.width, 1));
        }
        let (rotate, stretch) = (self.rotate, self.stretch);
        let quoted = |number: f64| format!("'{number}'");
        Setting::Rotate.require(Self::ROTATIONS_DEG.contains(&rotate), &quoted(rotate))?;
        Setting::Stretch.require(Self::STRETCHES.contains(&stretch), &quoted(stretch))
    }

    /// Returns the centre in the units of the axes; call [`View::check`] first. A coordinate that
    /// differs from ±π only in its last digits, far below a pixel, counts as exactly ±π, so that
    /// symmetry is detected.
    pub fn center_rad(&self) -> [Exact; 2] {
        let error_rad = MAX_PI_ERROR * self.width_rad().hi;
        self.center.each_ref().map(|text| {
            let theta = Exact::parse(text).unwrap_or_default();
            let pi = if theta < Exact::ZERO { -Exact::pi() } else { Exact::pi() };
            if (theta - pi).to_f64().abs() <= error_rad { pi } else { theta }
        })
    }

    /// Returns the width in the unit of the horizontal axis; call [`View::check`] first.
    pub fn width_rad(&self) -> Dd {
        Dd::parse(&self.width).unwrap_or(Dd::TAU)
    }

    /// Returns the view for a picture of this width and height, with `fit` cleared. If the vertical
    /// axis would span less than `width`, the width grows until it spans that much; otherwise the
    /// width's text stays unchanged.
    #[must_use]
    pub fn fitted(&self, [width, height]: [f64; 2]) -> Self {
        let wider = width * self.stretch / height;
        let view = View { fit: false, ..self.clone() };
        if !self.fit || wider <= 1.0 {
            return view;
        }
        let fitted = self.width_rad() * Dd::new(wider);
        // More digits than any pixel needs.
        let decimals = (25.0 - fitted.hi.log10()).ceil().max(0.0) as usize;
        View { width: fitted.decimal(decimals), ..view }
    }

    /// Returns true if (θ1, θ2) → (−θ1, −θ2) maps the picture onto itself, pixel by pixel: its
    /// centre is a fixed point, which is 0 or, for coordinates that repeat, π.
    pub(crate) fn is_symmetric(&self, wraps: [bool; 2]) -> bool {
        let fixed =
            |theta: Exact, wraps| theta == Exact::ZERO || wraps && theta.abs() == Exact::pi();
        self.center_rad().into_iter().zip(wraps).all(|(theta, wraps)| fixed(theta, wraps))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn home() -> View {
        BuiltIn::home().document().view
    }

    #[test]
    fn a_fitted_view_shows_both_axes_in_any_shape() {
        for (size, wider) in [([1920.0, 1080.0], 1920.0 / 1080.0), ([600.0, 900.0], 1.0)] {
            let fitted = home().fitted(size);
            assert!(!fitted.fit && fitted.check([Axis::Theta1, Axis::Theta2]).is_ok());
            assert!((fitted.width_rad() - Dd::TAU * Dd::new(wider)).abs().hi < 1e-15);
            let height_rad = fitted.width_rad().hi * size[1] / size[0];
            assert!(height_rad >= std::f64::consts::TAU - 1e-12);
        }
        let plain = View { fit: false, ..home() };
        assert_eq!(plain.fitted([1920.0, 1080.0]), plain, "what is not asked to fit stays");
        assert_eq!(home().fitted([10.0, 10.0]).width, home().width, "to its last digit");
    }

    #[test]
    fn only_centres_that_are_their_own_images_are_symmetric() {
        let at = |center: [&str; 2]| View { center: center.map(str::to_string), ..View::default() };
        let pi = "-3.141592653589793";
        for (center, wraps, symmetric) in [
            (["0", "0"], [false; 2], true),
            ([pi, "0"], [true; 2], true),
            ([pi, "0"], [false, true], false),
            (["3.14159265", "0"], [true; 2], false),
            (["0", "1e-30"], [true; 2], false),
        ] {
            assert_eq!(at(center).is_symmetric(wraps), symmetric, "{center:?}");
        }
    }
}
