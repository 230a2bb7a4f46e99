//! Waiting in a page: the browser gets a turn, and the program is called again.

use std::pin::Pin;

use js_sys::Promise;
use wasm_bindgen::JsCast;
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::JsFuture;

#[wasm_bindgen]
extern "C" {
    #[wasm_bindgen(js_name = setTimeout)]
    fn set_timeout(then: &js_sys::Function, milliseconds: i32);
}

/// Gives the browser a turn.
pub(crate) fn turn() -> Pin<Box<dyn Future<Output = ()>>> {
    let promise = Promise::new(&mut |resolve, _| set_timeout(resolve.unchecked_ref(), 1));
    Box::pin(async move {
        // A timeout is never refused.
        let _ = JsFuture::from(promise).await;
    })
}
