//! Waiting for a device: a thread sleeps, while a page in a browser has to return to the browser
//! and be called again.

use std::pin::Pin;

use crate::clock::Instant;
use crate::{Engine, EngineError, JobResult, Wait};

/// How to wait for a device.
#[derive(Clone, Copy)]
pub enum Waiting<'a> {
    /// The thread sleeps.
    Sleep,
    /// The function is called and awaited again and again, until the device has finished.
    Pause(&'a dyn Fn() -> Pin<Box<dyn Future<Output = ()>>>),
}

impl Waiting<'_> {
    /// Waits until the device may have finished.
    pub(crate) async fn once(self, device: &wgpu::Device) -> Result<(), EngineError> {
        match self {
            Waiting::Sleep => {
                let waited = device.poll(wgpu::PollType::wait_indefinitely());
                waited.map(drop).map_err(|error| EngineError::Driver(error.to_string()))
            }
            Waiting::Pause(pause) => {
                pause().await;
                Ok(())
            }
        }
    }

    /// Returns the next jobs that an engine finishes.
    pub(crate) async fn finished(
        self,
        engine: &mut dyn Engine,
    ) -> Result<Vec<JobResult>, EngineError> {
        let Waiting::Pause(pause) = self else { return engine.poll(Wait::UntilFinished) };
        loop {
            let finished = engine.poll(Wait::Until(Instant::now()))?;
            if !finished.is_empty() {
                return Ok(finished);
            }
            pause().await;
        }
    }
}

/// Returns the result of a future, for which this thread waits.
#[cfg(not(target_arch = "wasm32"))]
pub(crate) fn now<T>(future: impl Future<Output = T>) -> Option<T> {
    Some(pollster::block_on(future))
}

/// Returns the result of a future that is ready; none otherwise, because a page may not wait.
#[cfg(target_arch = "wasm32")]
pub(crate) fn now<T>(future: impl Future<Output = T>) -> Option<T> {
    use std::task::{Context, Poll, Waker};

    let mut future = std::pin::pin!(future);
    match future.as_mut().poll(&mut Context::from_waker(Waker::noop())) {
        Poll::Ready(result) => Some(result),
        Poll::Pending => None,
    }
}

/// True where a thread can sleep until a device has finished.
pub(crate) const CAN_SLEEP: bool = cfg!(not(target_arch = "wasm32"));
