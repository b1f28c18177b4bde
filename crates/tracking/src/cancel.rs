//! Stopping long work from outside.

pub use backlit_cancel::CancelToken;
