//! The notices of the window: plain sentences. Failures stay until they are closed; other notices
//! disappear after a while, unless the pointer rests on them.

/// A notice of one sentence.
#[derive(Clone, Debug, PartialEq)]
pub struct Notice {
    /// Identifier of the notice.
    pub id: u64,
    /// Text that says what happened, and what to do.
    pub text: String,
    /// True if something went wrong.
    pub failure: bool,
    /// Moment on the window's clock, in s, at which it was first shown.
    shown_secs: Option<f64>,
}

/// The notices shown, the newest last.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Notices {
    list: Vec<Notice>,
    next_id: u64,
    /// True if the pointer was on them in the last frame.
    held: bool,
}

/// Largest number of notices shown at once.
const MAX_NOTICES: usize = 4;
/// Time in s for which a notice is shown, unless it is a failure.
const FADES_AFTER_SECS: f64 = 8.0;

impl Notice {
    /// Returns the moment on the window's clock, in s, at which the notice disappears; none if it
    /// stays.
    fn ends_secs(&self) -> Option<f64> {
        self.shown_secs.filter(|_| !self.failure).map(|shown| shown + FADES_AFTER_SECS)
    }
}

impl Notices {
    /// Shows something that is good to know.
    pub(crate) fn tell(&mut self, text: impl Into<String>) {
        self.push(text.into(), false);
    }

    /// Shows and logs what went wrong and what to do.
    pub(crate) fn fail(&mut self, text: impl Into<String>) {
        let text = text.into();
        log::warn!("{text}");
        self.push(text, true);
    }

    /// Removes a notice.
    pub(crate) fn dismiss(&mut self, id: u64) {
        self.list.retain(|notice| notice.id != id);
    }

    /// Keeps the notices for now, because the pointer is on them.
    pub(crate) fn hold(&mut self) {
        self.held = true;
    }

    /// Advances to a moment of the window's clock, in s, and removes notices whose time is over;
    /// that of notices that are held begins again.
    pub(crate) fn advance(&mut self, now_secs: f64) {
        let held = std::mem::take(&mut self.held);
        for notice in &mut self.list {
            notice.shown_secs = notice.shown_secs.filter(|_| !held).or(Some(now_secs));
        }
        self.list.retain(|notice| notice.ends_secs().is_none_or(|ends| ends > now_secs));
    }

    /// Returns the moment on the window's clock, in s, at which the next notice disappears, if any
    /// does.
    pub(crate) fn next_end_secs(&self) -> Option<f64> {
        self.list.iter().filter_map(Notice::ends_secs).min_by(f64::total_cmp)
    }

    /// Returns the notices shown.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &Notice> {
        self.list.iter()
    }

    /// Adds a notice; one that is already shown is moved to the end instead of repeated.
    fn push(&mut self, text: String, failure: bool) {
        self.list.retain(|notice| notice.text != text);
        let id = self.next_id;
        self.next_id += 1;
        self.list.push(Notice { id, text, failure, shown_secs: None });
        if self.list.len() > MAX_NOTICES {
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

    #[test]
    fn the_pointer_holds_them() {
        let mut notices = Notices::default();
        notices.tell("copied");
        notices.advance(1.0);
        for now_secs in [5.0, 9.5, 20.0] {
            notices.hold();
            notices.advance(now_secs);
        }
        assert_eq!((notices.iter().len(), notices.next_end_secs()), (1, Some(28.0)));
        notices.advance(27.9);
        assert_eq!(notices.iter().len(), 1);
        notices.advance(28.0);
        assert_eq!(notices.iter().len(), 0, "they leave once the pointer has left");
    }

    #[test]
    fn what_is_good_to_know_goes_and_failures_stay() {
        let mut notices = Notices::default();
        notices.fail("broken");
        notices.tell("copied");
        assert_eq!(notices.next_end_secs(), None, "not shown yet");
        notices.advance(100.0);
        notices.tell("kept");
        notices.advance(103.0);
        assert_eq!(notices.next_end_secs(), Some(108.0));
        let texts = |notices: &Notices| -> Vec<String> {
            notices.iter().map(|notice| notice.text.clone()).collect()
        };
        notices.advance(107.9);
        assert_eq!(texts(&notices), ["broken", "copied", "kept"]);
        notices.advance(108.0);
        assert_eq!(
            (texts(&notices), notices.next_end_secs()),
            (vec!["broken".into(), "kept".into()], Some(111.0))
        );
        notices.tell("kept");
        notices.advance(110.0);
        notices.advance(111.0);
        assert_eq!(texts(&notices), ["broken", "kept"], "told again, it stays for as long again");
        notices.advance(1e9);
        assert_eq!((texts(&notices), notices.next_end_secs()), (vec!["broken".into()], None));
    }
}
