//! Pictures of the 3-D scene, made on the CPU.

pub mod scene;
