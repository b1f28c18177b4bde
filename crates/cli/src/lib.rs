//! Backlit's commands without a window. What a command computes is the core's; here are words and files.
//!
//! | file | holds |
//! |---|---|
//! | `command` | the commands and their help |
//! | `fit_options` | options that choose renderer, ramp and solver |
//! | `render` | `backlit render` |
//! | `fit` | `backlit fit` |
//! | `fit_body`, `fit_body_report` | `backlit fit-body` |
//! | `evidence` | silhouettes and grey levels from a folder |
//! | `import` | `backlit import` |
//! | `track` | `backlit track` |
//! | `track_report`, `track_files` | how good a track is, and the files with it |
//! | `export` | `backlit export` |
//! | `observability` | `backlit observability` |
//! | `silhouettes` | `backlit silhouettes` |
//! | `sync` | `backlit sync` |
//! | `sphere_tree` | `backlit sphere-tree` |
//! | `prior` | `backlit prior` |
//! | `cameras` | `backlit cameras` |
//! | `recognise` | `backlit recognise` |
//! | `experiment` | `backlit experiment`: one file an experiment |
//! | `take_options` | options that choose frames, cameras, start and keypoints to compare with |
//! | `follow_options` | options that choose how frames are followed |
//! | `person` | a start and sizes where the take has none |
//! | `progress` | progress on the terminal |
//! | `interrupt` | Ctrl+C |
//! | `table` | tables for people |
//! | `output` | standard output and folders |

mod background;
mod cameras;
mod command;
mod evidence;
mod experiment;
mod export;
mod fit;
mod fit_body;
mod fit_body_report;
mod fit_options;
mod follow_options;
mod import;
pub mod interrupt;
mod observability;
pub mod output;
mod person;
mod prior;
mod progress;
mod recognise;
mod render;
mod silhouettes;
mod sphere_tree;
mod sync;
mod table;
mod take_options;
mod track;
mod track_files;
mod track_report;

pub use command::Command;
pub use track::print_robust_track;
