//! What a window has left, in words.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::SystemTime;

use backlit_document::{Document, Origin};
use backlit_take::source::TakeSource;
use egui::ColorImage;

use super::About;
use crate::context::clock::Clock;

/// Work that a window has left.
#[derive(Debug, Clone, PartialEq)]
pub struct Left {
    /// The copy.
    pub path: PathBuf,
    /// When it was written last.
    pub(crate) saved: Option<SystemTime>,
    /// Where the user was.
    pub(crate) about: About,
    /// The take: "balancing", "Built-in take".
    pub(crate) take: String,
    /// Frames whose pose was set by hand.
    pub(crate) by_hand: usize,
    /// Frames whose pose was fitted.
    pub(crate) fitted: usize,
    /// Frames whose pose was tracked.
    pub(crate) tracked: usize,
    /// What the camera on the screen showed, if that was kept.
    pub(crate) picture: Option<Arc<ColorImage>>,
}

impl Left {
    /// What a document holds, and when it was written.
    pub(crate) fn new(
        path: PathBuf,
        document: &Document,
        about: About,
        saved: Option<SystemTime>,
        picture: Option<ColorImage>,
    ) -> Self {
        let found = |origin| document.estimates.values().filter(|estimate| estimate.origin == origin).count();
        Self {
            take: take_of(document, &about),
            by_hand: document.keys.len(),
            fitted: found(Origin::Fit),
            tracked: found(Origin::Track),
            picture: picture.map(Arc::new),
            path,
            saved,
            about,
        }
    }

    /// When it was written: "today 14:32, 12 minutes ago".
    pub(crate) fn when(&self, clock: &Clock) -> String {
        let when = self.saved.and_then(|saved| clock.when(saved));
        let ago = self.saved.and_then(|saved| clock.ago(saved));
        let parts: Vec<String> = [when, ago].into_iter().flatten().collect();
        if parts.is_empty() { "some time ago".to_owned() } else { parts.join(", ") }
    }

    /// Where the user was: "At frame 30 of 70".
    pub(crate) fn place(&self) -> String {
        match self.about.frames {
            Some(frames @ 2..) => format!("At frame {} of {frames}", self.about.frame),
            _ => format!("At frame {}", self.about.frame),
        }
    }

    /// What has been done: "3 poses by hand, 1 fitted, 31 tracked".
    pub(crate) fn work(&self) -> String {
        let poses = |count: usize| if count == 1 { "1 pose".to_owned() } else { format!("{count} poses") };
        let kinds = [(self.by_hand, "set by hand"), (self.fitted, "fitted"), (self.tracked, "tracked")];
        let mut parts = kinds.iter().filter(|(count, _)| *count > 0);
        let first = parts.next().map(|(count, how)| format!("{} {how}", poses(*count)));
        let rest = parts.map(|(count, how)| format!("{count} {how}"));
        let all: Vec<String> = first.into_iter().chain(rest).collect();
        if all.is_empty() { "No poses yet, only settings".to_owned() } else { all.join(", ") }
    }

    /// The file that it belongs to: "Unsaved changes of work.backlit".
    pub(crate) fn belongs(&self) -> String {
        let name = self.about.project.as_deref().and_then(|path| path.file_name());
        match name {
            Some(name) => format!("Unsaved changes of {}", name.to_string_lossy()),
            None => "Never saved to a file".to_owned(),
        }
    }
}

fn take_of(document: &Document, about: &About) -> String {
    match (&document.take, &about.take) {
        (Some(TakeSource::Demonstration(which)), _) => format!("Demonstration “{}”", which.name()),
        (Some(TakeSource::Path(_)), Some(name)) => name.clone(),
        (Some(TakeSource::Path(path)), None) => {
            path.file_name().map_or_else(|| "Take".into(), |name| name.to_string_lossy().into_owned())
        }
        _ => "Built-in take".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;
    use std::time::Duration;

    use backlit_tracking::body::{Pose, builtin};

    use super::*;

    #[test]
    fn what_was_left_is_said_so_that_one_can_decide() {
        let saved = SystemTime::UNIX_EPOCH + Duration::from_secs(1_795_271_520);
        let clock = Clock::fixed(saved + Duration::from_secs(720), 0).unwrap();
        let mut document = Document::new(builtin::single_limb());
        document.take = Some(TakeSource::Path(PathBuf::from("/takes/b")));
        let about = About {
            frame: 30,
            frames: Some(70),
            take: Some("balancing".to_owned()),
            project: Some(PathBuf::from("/work/arm.backlit")),
        };
        let left = |document: &Document, about: &About| {
            Left::new(PathBuf::from("unsaved.backlit"), document, about.clone(), Some(saved), None)
        };
        let nothing = left(&document, &About::default());
        assert_eq!((nothing.take.as_str(), nothing.place()), ("b", "At frame 0".to_owned()));
        assert_eq!(
            (nothing.work(), nothing.belongs()),
            ("No poses yet, only settings".into(), "Never saved to a file".into())
        );
        let pose = Pose::rest(&document.model);
        document.keys = Arc::new(BTreeMap::from([(3, pose.clone()), (4, pose)]));
        let some = left(&document, &about);
        assert_eq!(some.take, "balancing");
        assert_eq!(some.when(&clock), "today 14:32, 12 minutes ago");
        assert_eq!(some.place(), "At frame 30 of 70");
        assert_eq!(some.belongs(), "Unsaved changes of arm.backlit");
        assert_eq!(some.work(), "2 poses set by hand");
        let both = Left { by_hand: 1, tracked: 31, ..some.clone() };
        assert_eq!(both.work(), "1 pose set by hand, 31 tracked");
        assert_eq!(Left { saved: None, ..some }.when(&clock), "some time ago");
    }
}
