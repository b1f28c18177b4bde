//! The built program, run as people and programs run it.

mod fit;
mod render;
mod scene;
mod track;
mod words;
