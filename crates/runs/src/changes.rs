//! What is said of backgrounds that change while a take is filmed.

use backlit_formats::Take;
use backlit_tracking::segment::changes::{BackgroundChange, ChangeKind};
use backlit_words::format;

/// "cam02: a thing stands in the picture from frame 20 (0.67 s) on, 3 100 px: the background is learnt again".
#[must_use]
pub fn change_text(change: &BackgroundChange, take: &Take) -> String {
    let seconds = take.seconds();
    let at = |frame: usize| match seconds.get(frame) {
        Some(&second) => format!("frame {frame} ({} s)", format::number(second, 2)),
        None => format!("frame {frame}"),
    };
    let camera = take.rig().cameras().get(change.camera).map_or("a camera", |camera| camera.name());
    let span = match change.until {
        Some(until) => format!("from {} to {}", at(change.from), at(until)),
        None => format!("from {} on", at(change.from)),
    };
    let size = format!("{} px", format::count(change.pixels.len() as i64));
    let what = match change.kind {
        ChangeKind::Thing => format!("a thing stands in the picture {span}, {size}"),
        ChangeKind::Light => format!("the light is another {span}"),
        ChangeKind::Knock => format!("the camera stands otherwise {span}, as after a knock, {size}"),
    };
    format!("{camera}: {what}: the background is learnt again")
}
