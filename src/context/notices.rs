//! What the program says in passing: the newest few as cards, all of them in *Help › Messages*.

use backlit_jobs::{Failure, Task};

use crate::context::command::Command;

/// Time that a card stays, in seconds.
const LIFETIME: f64 = 6.0;
/// Cards at once.
const MAX_CARDS: usize = 3;
/// Messages that are kept.
const MAX_KEPT: usize = 200;

/// How bad it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Severity {
    /// Good to know.
    Info,
    /// Something did not work; the card stays until it is closed.
    Error,
}

/// One sentence, and at most one button.
#[derive(Debug, Clone, PartialEq)]
pub struct Notice {
    /// Names it for closing.
    pub(crate) id: u64,
    pub(crate) severity: Severity,
    /// The sentence.
    pub text: String,
    pub(crate) command: Option<Command>,
    /// When it was said, in seconds of the window's clock.
    pub(crate) said: f64,
    /// When it goes, in seconds of the window's clock; `None` for errors and what waits for a decision.
    expires: Option<f64>,
    is_open: bool,
}

/// All that was said since the start.
#[derive(Debug, Default)]
pub struct Notices {
    kept: Vec<Notice>,
    next_id: u64,
    /// The window's clock.
    pub(crate) now: f64,
}

impl Notices {
    /// Says something good to know.
    pub(crate) fn info(&mut self, text: impl Into<String>, command: Option<Command>) {
        self.push(Severity::Info, text.into(), command, Some(self.now + LIFETIME));
    }

    /// Says what waits for a decision: the card stays until it is closed.
    pub(crate) fn remind(&mut self, text: impl Into<String>, command: Command) {
        self.push(Severity::Info, text.into(), Some(command), None);
    }

    /// Says that something did not work.
    pub(crate) fn error(&mut self, text: impl Into<String>) {
        self.push(Severity::Error, text.into(), None, None);
    }

    /// Says that something did not work, and offers a command that helps.
    pub(crate) fn error_with(&mut self, text: impl Into<String>, command: Command) {
        self.push(Severity::Error, text.into(), Some(command), None);
    }

    /// What a task has sent since the last call. That it broke down is said, and what it was `doing`, as the beginning of a
    /// sentence.
    pub(crate) fn outputs<I, O, const P: u8>(&mut self, doing: &str, task: &mut Task<I, O, P>) -> Vec<O> {
        task.outputs(|failure| self.error(broke_down(doing, failure)))
    }

    /// The cards on the screen, the newest last.
    pub(crate) fn cards(&self) -> impl Iterator<Item = &Notice> {
        let open = self.kept.iter().filter(|notice| notice.is_open).count();
        self.kept.iter().filter(|notice| notice.is_open).skip(open.saturating_sub(MAX_CARDS))
    }

    /// All messages, the newest last.
    pub fn all(&self) -> &[Notice] {
        &self.kept
    }

    /// Closes the cards of which `is` says so; they stay among the messages.
    pub(crate) fn close(&mut self, is: impl Fn(&Notice) -> bool) {
        self.kept.iter_mut().filter(|notice| is(notice)).for_each(|notice| notice.is_open = false);
    }

    /// Closes the cards that nobody has to decide about.
    pub(crate) fn close_passing(&mut self) {
        self.close(|notice| notice.expires.is_some() || notice.severity == Severity::Error);
    }

    /// Closes all cards.
    pub fn close_all(&mut self) {
        self.close(|_| true);
    }

    /// Closes the cards whose time is over, and says when the next one's will be.
    pub(crate) fn tick(&mut self) -> Option<f64> {
        let now = self.now;
        let mut next: Option<f64> = None;
        for notice in self.kept.iter_mut().filter(|notice| notice.is_open) {
            match notice.expires {
                Some(expires) if expires <= now => notice.is_open = false,
                Some(expires) => next = Some(next.map_or(expires, |other| other.min(expires))),
                None => {}
            }
        }
        next
    }

    /// A card under the pointer stays.
    pub(crate) fn hold(&mut self, id: u64) {
        for notice in self.kept.iter_mut().filter(|notice| notice.id == id) {
            notice.expires = notice.expires.map(|_| self.now + LIFETIME);
        }
    }

    fn push(&mut self, severity: Severity, text: String, command: Option<Command>, expires: Option<f64>) {
        if self.kept.len() == MAX_KEPT {
            self.kept.remove(0);
        }
        // The same sentence twice is one card.
        self.close(|notice| notice.text == text);
        let (id, said) = (self.next_id, self.now);
        self.kept.push(Notice { id, severity, text, command, said, expires, is_open: true });
        self.next_id += 1;
    }
}

/// What is said of a job that broke down, and of what it was doing.
pub(crate) fn broke_down(doing: &str, failure: &Failure) -> String {
    format!("{doing} broke down: {failure}. Your work is unharmed.")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::context::command::RecoveryCommand;

    #[test]
    fn cards_go_by_themselves_and_errors_stay() {
        let mut notices = Notices::default();
        notices.info("Saved", None);
        notices.error("No such file");
        notices.remind("Unsaved work is kept", Command::Recovery(RecoveryCommand::Show));
        notices.now = 1.0;
        assert_eq!(notices.tick(), Some(6.0));
        assert_eq!(notices.cards().count(), 3);
        notices.now = 6.5;
        assert_eq!(notices.tick(), None);
        let texts = |notices: &Notices| notices.cards().map(|notice| notice.text.clone()).collect::<Vec<_>>();
        assert_eq!(texts(&notices), ["No such file", "Unsaved work is kept"]);
        notices.close_passing();
        assert_eq!(texts(&notices), ["Unsaved work is kept"]);
        assert_eq!((notices.cards().count(), notices.all().len()), (1, 3));
    }

    #[test]
    fn at_most_three_cards_are_shown_and_none_twice() {
        let mut notices = Notices::default();
        for text in ["a", "b", "c", "d", "d"] {
            notices.info(text, None);
        }
        let texts: Vec<&str> = notices.cards().map(|notice| notice.text.as_str()).collect();
        assert_eq!(texts, ["b", "c", "d"]);
    }
}
