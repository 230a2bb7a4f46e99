//! What the window has to say: plain sentences that stay until they are read.

/// One sentence.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Notice {
    /// Its own name.
    pub id: u64,
    /// What happened, and what to do.
    pub text: String,
    /// Whether something went wrong.
    pub failure: bool,
}

/// The sentences shown, the newest last.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Notices {
    list: Vec<Notice>,
    next_id: u64,
}

/// Shown at once.
const MOST: usize = 4;

impl Notices {
    /// Says something good to know.
    pub fn tell(&mut self, text: impl Into<String>) {
        self.push(text.into(), false);
    }

    /// Says what went wrong and what to do.
    pub fn fail(&mut self, text: impl Into<String>) {
        let text = text.into();
        log::warn!("{text}");
        self.push(text, true);
    }

    /// Takes one away.
    pub fn dismiss(&mut self, id: u64) {
        self.list.retain(|notice| notice.id != id);
    }

    /// Those shown.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &Notice> {
        self.list.iter()
    }

    /// The same sentence twice is shown once, as the newest.
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
