//! How everything looks: colours, sizes, and the form of every number.

pub mod theme;

pub use backlit_words::format;
