//! Painting and writing, one picture a step.

use backlit_formats::images;
use backlit_jobs::{Job, Outbox, Turn};
use backlit_tracking::cancel::CancelToken;
use image::DynamicImage;

use super::choices::{Painter, Shot};
use super::{ExportError, ExportOrder, SeriesWriter};
use crate::context::Context;

/// What an export says.
#[derive(Debug)]
pub(super) enum Exported {
    /// This many pictures are done.
    Pictures(usize),
    /// All are.
    Whole,
    /// It was stopped.
    Stopped,
    /// It could not be written.
    Failed(ExportError),
}

/// Pictures to be painted and written.
pub(crate) struct ExportJob {
    painter: Box<dyn Painter>,
    shots: Vec<(usize, Shot)>,
    done: usize,
    order: ExportOrder,
    /// There is one from the first picture of a series on.
    writer: Option<SeriesWriter>,
}

impl ExportJob {
    /// What an order asks for, painted by `painter`.
    pub(crate) fn new(order: &ExportOrder, context: &Context<'_>, painter: Box<dyn Painter>) -> Self {
        Self { painter, shots: order.shots(context), done: 0, order: order.clone(), writer: None }
    }

    pub(crate) const fn len(&self) -> usize {
        self.shots.len()
    }

    /// Paints and writes all. Errors: what cannot be written, with the file's name.
    pub(crate) fn finish(mut self) -> Result<(), ExportError> {
        while self.next(&CancelToken::default())? {}
        Ok(())
    }

    /// Paints and writes the next picture; whether there was one.
    fn next(&mut self, cancel: &CancelToken) -> Result<bool, ExportError> {
        let ExportOrder { path, choices, .. } = &self.order;
        if self.writer.is_none()
            && let Some(name) = self.order.subject.series()
        {
            self.writer = Some(SeriesWriter::new(path, name, choices, self.shots.len())?);
        }
        let Some((number, shot)) = self.shots.get(self.done).copied() else {
            self.writer.take().map_or(Ok(()), SeriesWriter::finish)?;
            return Ok(false);
        };
        if cancel.is_cancelled() {
            return Err(ExportError::Stopped);
        }
        let picture = self.painter.paint(shot, cancel);
        if cancel.is_cancelled() {
            return Err(ExportError::Stopped);
        }
        match &mut self.writer {
            Some(writer) => writer.add(number, picture)?,
            None => images::write_png(path, &DynamicImage::ImageRgb8(picture))?,
        }
        self.done += 1;
        Ok(true)
    }
}

impl Job<Exported> for ExportJob {
    fn step(&mut self, out: &Outbox<Exported>) -> Turn {
        let (said, step) = match self.next(out.cancel()) {
            Ok(true) => (Exported::Pictures(self.done), Turn::Again),
            Ok(false) => (Exported::Whole, Turn::Done),
            Err(_) if out.cancel().is_cancelled() => (Exported::Stopped, Turn::Done),
            Err(error) => (Exported::Failed(error), Turn::Done),
        };
        out.send(said);
        step
    }
}
