//! The basin of a frame: ways of fitting, what came of them, and files of it.

mod compared;
mod files;
mod results;

pub use compared::{
    Compared, ComparedWay, MOST_COMPARED, ParseComparedError, angle_name, direction_name, name_choices,
};
pub use files::FORMAT;
pub use results::{About, AnglesResult, FitCount, MapResult};
