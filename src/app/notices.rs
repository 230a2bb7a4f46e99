//! The notices of the window: plain sentences that stay until they are read.

/// A notice of one sentence.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Notice {
    /// Identifier of the notice.
    pub id: u64,
    /// Text that says what happened, and what to do.
    pub text: String,
    /// True if something went wrong.
    pub failure: bool,
}

/// The notices shown, the newest last.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Notices {
    list: Vec<Notice>,
    next_id: u64,
}

/// Largest number of notices shown at once.
const MOST: usize = 4;

impl Notices {
    /// Shows something that is good to know.
    pub fn tell(&mut self, text: impl Into<String>) {
        self.push(text.into(), false);
    }

    /// Shows and logs what went wrong and what to do.
    pub fn fail(&mut self, text: impl Into<String>) {
        let text = text.into();
        log::warn!("{text}");
        self.push(text, true);
    }

    /// Removes a notice.
    pub fn dismiss(&mut self, id: u64) {
        self.list.retain(|notice| notice.id != id);
    }

    /// Returns the notices shown.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &Notice> {
        self.list.iter()
    }

    /// Adds a notice; a sentence shown already is moved to the end, not repeated.
    fn push(&mut self, text: String, failure: bool) {
        self.list.retain(|notice| notice.text != text);
        let id = self.next_id;
        self.next_id += 1;
        self.list.push(Notice { id, text, failure });
        if self.list.len() > MOST {
            self.list.remove(0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_few_are_shown_once_each() {
        let mut notices = Notices::default();
        for text in ["a", "b", "a", "c", "d", "e"] {
            notices.fail(text);
        }
        let texts: Vec<&str> = notices.iter().map(|notice| notice.text.as_str()).collect();
        assert_eq!(texts, ["a", "c", "d", "e"]);
        let first = notices.iter().next().unwrap().id;
        notices.dismiss(first);
        assert_eq!(notices.iter().len(), 3);
    }
}
