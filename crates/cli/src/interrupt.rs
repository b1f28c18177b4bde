//! Ctrl+C: the first one asks work to end in order, so that what is done is written; a second one ends the program at once.

use std::sync::OnceLock;

use anyhow::Context;
use backlit_tracking::cancel::CancelToken;
use thiserror::Error;

/// The exit code of a program that Ctrl+C has ended.
pub const EXIT_CODE: u8 = 130;

/// Ctrl+C was pressed.
#[derive(Debug, Clone, Copy, Error)]
#[error("stopped by Ctrl+C")]
pub struct Interrupted;

/// Listens from now on; the token is cancelled by the first Ctrl+C.
pub fn listen() -> anyhow::Result<CancelToken> {
    static TOKEN: OnceLock<CancelToken> = OnceLock::new();
    if let Some(token) = TOKEN.get() {
        return Ok(token.clone());
    }
    let token = TOKEN.get_or_init(CancelToken::new).clone();
    let pressed = token.clone();
    let handler = move || {
        if pressed.is_cancelled() {
            std::process::exit(i32::from(EXIT_CODE));
        }
        pressed.cancel();
    };
    ctrlc::set_handler(handler).context("Ctrl+C cannot be listened to")?;
    Ok(token)
}
