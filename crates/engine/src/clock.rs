//! The clock that all waiting and measuring uses: the system's, or a page's in a browser, where the
//! standard library has none.

#[cfg(not(target_arch = "wasm32"))]
pub use std::time::Instant;
#[cfg(target_arch = "wasm32")]
pub use web_time::Instant;
