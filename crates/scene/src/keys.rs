//! The keys of a film: scenes, each with the time at which the camera is there.

use serde::{Deserialize, Serialize};

use super::document::{DocumentError, check_format, one_line};
use super::{Document, document::FORMAT};

/// A file of keys.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Keys {
    /// Version of the file format.
    pub format: u32,
    /// The keys, ordered by time.
    #[serde(rename = "key")]
    pub keys: Vec<Key>,
}

/// A scene and the time at which the camera is there.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Key {
    /// Time in the film, s.
    pub secs: f64,
    /// Motion of the camera on its way from the previous key.
    #[serde(default)]
    pub easing: Easing,
    /// Simulated seconds that have passed at this key; later flips are not shown yet.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clock: Option<f64>,
    /// The scene that the camera sees.
    #[serde(default)]
    pub scene: Document,
}

/// Motion of the camera between two keys.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Easing {
    /// A motion that starts and stops gently.
    #[default]
    Smooth,
    /// A motion at constant speed.
    Linear,
}

impl Easing {
    /// Returns the share of the way covered after a share of the time.
    pub(crate) fn share(self, time: f64) -> f64 {
        match self {
            Easing::Smooth => time * time * (3.0 - 2.0 * time),
            Easing::Linear => time,
        }
    }
}

/// Seconds from the previous key to an appended one: `STOP_SECS` if the camera stops there, and
/// `PASS_SECS` if it only passes.
const STOP_SECS: f64 = 5.0;
const PASS_SECS: f64 = 1.0;

impl Default for Keys {
    fn default() -> Self {
        Keys { format: FORMAT, keys: Vec::new() }
    }
}

/// Reasons why a text is not a file of keys.
#[derive(Debug, thiserror::Error)]
pub enum KeysError {
    /// An error in a key's scene, or in the file as a whole.
    #[error(transparent)]
    Document(#[from] DocumentError),
    /// A time that is out of range, or not later than that of the key before.
    #[error("key {number} is at {secs} s; each must be later than the one before, from 0 to 1e6 s")]
    Time {
        /// Number of the key, from 1.
        number: usize,
        /// Time of the key, s.
        secs: f64,
    },
}

impl Keys {
    /// Reads and checks keys.
    pub fn parse(text: &str) -> Result<Self, KeysError> {
        check_format(text)?;
        let mut keys: Keys =
            toml::from_str(text).map_err(|error| DocumentError::Syntax(one_line(&error, text)))?;
        let mut before = -1.0;
        for (key, number) in keys.keys.iter_mut().zip(1..) {
            if !(0.0..=1e6).contains(&key.secs) || key.secs <= before {
                return Err(KeysError::Time { number, secs: key.secs });
            }
            key.scene = std::mem::take(&mut key.scene).in_units().checked()?;
            before = key.secs;
        }
        Ok(keys)
    }

    /// Returns the keys as TOML.
    pub fn text(&self) -> String {
        toml::to_string(self).expect("plain tables are TOML")
    }

    /// Appends a scene: the first at 0 s, and any other five seconds after the last key for a
    /// smooth stop or one second after it for a view that is only passed.
    pub fn append(&mut self, scene: Document, easing: Easing) {
        let step = if easing == Easing::Smooth { STOP_SECS } else { PASS_SECS };
        let secs = self.keys.last().map_or(0.0, |last| last.secs + step);
        self.keys.push(Key { secs, easing, clock: None, scene });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn appended_scenes_come_back_in_order() {
        let mut keys = Keys::parse("").unwrap();
        assert_eq!(keys, Keys::default());
        for width in ["1", "0.5", "0.1"] {
            let mut scene = Document::default();
            scene.view.width = width.to_string();
            keys.append(scene, if width == "0.1" { Easing::Linear } else { Easing::Smooth });
        }
        let again = Keys::parse(&keys.text()).unwrap();
        assert_eq!(again, keys);
        assert_eq!(again.keys.iter().map(|key| key.secs).collect::<Vec<_>>(), [0.0, 5.0, 6.0]);
        assert_eq!(again.keys[2].scene.view.width, "0.1");
    }

    #[test]
    fn keys_are_short_where_the_scene_is_the_home_map() {
        let text = "[[key]]\nsecs = 2\n[[key]]\nsecs = 3.5\neasing = \"linear\"\n\
                    [key.scene.view]\nwidth = \"0.1\"\n";
        let pasted = Keys::parse(&text.replace("\"0.1\"", "\"10deg\"")).unwrap();
        assert!(pasted.keys[1].scene.view.width.starts_with("0.1745"));
        let keys = Keys::parse(text).unwrap();
        assert_eq!(keys.keys[0].scene, Document::default());
        assert_eq!((keys.keys[1].easing, keys.keys[1].secs), (Easing::Linear, 3.5));
    }

    #[test]
    fn bad_keys_are_refused_where_they_are_bad() {
        let refused = |text: &str| Keys::parse(text).unwrap_err().to_string();
        let twice = "[[key]]\nsecs = 2\n[[key]]\nsecs = 2\n";
        assert!(refused(twice).starts_with("key 2 is at 2 s; each must be later"));
        assert!(refused("[[key]]\nsecs = -1\n").starts_with("key 1 is at -1 s"));
        assert!(refused("[[key]]\nsecs = nan\n").starts_with("key 1 is at NaN s"));
        assert!(refused("[[key]]\ntime = 1\n").starts_with("line 2, column 1"));
        assert!(refused("format = 2").contains("format 2; this program reads"));
        let scene = "[[key]]\nsecs = 1\n[key.scene.view]\nwidth = \"0\"\n";
        assert!(refused(scene).contains("`width` is '0'"));
    }
}
