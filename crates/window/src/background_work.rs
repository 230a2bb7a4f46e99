//! Work on a thread of its own that sends news to the window and can be stopped.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};

use super::compute_service::lower_priority;

/// Work in the background. Dropping it asks the work to stop, and does not wait for it.
#[derive(Debug)]
pub(crate) struct BackgroundWork<T> {
    news: Receiver<T>,
    stopped: Arc<AtomicBool>,
    ended: Arc<AtomicBool>,
}

impl<T: Send + 'static> BackgroundWork<T> {
    /// Starts `work`, which waits when `ahead` pieces of news have not been taken yet. It has to stop
    /// once its second argument is true; by then nobody takes its news.
    pub(crate) fn start(
        ahead: usize,
        work: impl FnOnce(&SyncSender<T>, &AtomicBool) + Send + 'static,
    ) -> Self {
        Self::start_then(ahead, work, || ())
    }

    /// Works like [`Self::start`], and calls `then` once the work counts as ended.
    pub(crate) fn start_then(
        ahead: usize,
        work: impl FnOnce(&SyncSender<T>, &AtomicBool) + Send + 'static,
        then: impl FnOnce() + Send + 'static,
    ) -> Self {
        let (sender, news) = sync_channel(ahead);
        let stopped = Arc::new(AtomicBool::new(false));
        let ended = Arc::new(AtomicBool::new(false));
        let (stop, end) = (Arc::clone(&stopped), Arc::clone(&ended));
        std::thread::spawn(move || {
            lower_priority();
            work(&sender, &stop);
            end.store(true, Ordering::Release);
            then();
        });
        BackgroundWork { news, stopped, ended }
    }

    /// Returns the next piece of news, if there is one.
    pub(crate) fn news(&self) -> Option<T> {
        self.news.try_recv().ok()
    }

    /// Asks the work to stop.
    pub(crate) fn stop(&self) {
        self.stopped.store(true, Ordering::Relaxed);
    }

    /// Returns true if the work has ended; news may still be there.
    pub(crate) fn has_ended(&self) -> bool {
        self.ended.load(Ordering::Acquire)
    }
}

impl<T> Drop for BackgroundWork<T> {
    fn drop(&mut self) {
        self.stopped.store(true, Ordering::Relaxed);
    }
}
