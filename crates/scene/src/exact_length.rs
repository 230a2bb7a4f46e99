//! Arrays of an exact length in files; the TOML reader itself ignores surplus values.

use serde::de::Error;
use serde::{Deserialize, Deserializer};

/// Reads an array of `N` values, and refuses a longer or shorter one.
pub(super) fn exactly<'de, D: Deserializer<'de>, T: Deserialize<'de>, const N: usize>(
    from: D,
) -> Result<[T; N], D::Error> {
    let found = Vec::<T>::deserialize(from)?;
    let count = found.len();
    let values = if count == 1 { "value" } else { "values" };
    found.try_into().map_err(|_| D::Error::custom(format!("it has {count} {values}, not {N}")))
}

/// Reads an array of `N` values that may be left out.
pub(super) fn exactly_if_given<'de, D: Deserializer<'de>, T: Deserialize<'de>, const N: usize>(
    from: D,
) -> Result<Option<[T; N]>, D::Error> {
    exactly(from).map(Some)
}
