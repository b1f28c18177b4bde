//! The page to send: gathered and written in the background.

use std::path::PathBuf;

use anyhow::Context as _;
use backlit_formats::atomic;
use backlit_jobs::{Task, once};
use backlit_runs::report::{ReportOptions, ReportSource};
use backlit_ui::style::format;

use crate::context::command::{Command, ExportCommand};
use crate::context::file_dialog::DialogKind;
use crate::context::write_advice::write_advice;
use crate::context::{Context, Requests, priority};

/// Writes one page at a time.
#[derive(Debug, Default)]
pub(super) struct ReportWriter {
    task: Task<PathBuf, (PathBuf, anyhow::Result<()>), { priority::EXPORT }>,
}

/// What the desktop's dialog asks for.
pub(super) fn dialog(context: &Context<'_>) -> (&'static str, DialogKind) {
    ("Report", DialogKind::NewFile(format!("{}.html", context.take_name()), &["html"]))
}

impl ReportWriter {
    /// Begins a page about the poses as they are now; `path` gets the ending of a page.
    pub(super) fn begin(&mut self, path: PathBuf, context: &Context<'_>) {
        let Some(take) = &context.session.take else { return };
        let is_page =
            |ending: &std::ffi::OsStr| ["html", "htm"].iter().any(|known| ending.eq_ignore_ascii_case(known));
        let path =
            if path.extension().is_some_and(is_page) { path } else { path.with_added_extension("html") };
        let source = ReportSource::of_document(context.document(), take.clone());
        let command = context.project.map(|project| {
            let [project, path] = [project, &path].map(format::file_name);
            format!("backlit report '{project}' --out '{path}'")
        });
        let options = ReportOptions { command, ..ReportOptions::default() };
        self.task.begin(context.pool, path, move |path| {
            let path = path.clone();
            once(move |cancel| {
                let page = source.page(&options, cancel).context("the report");
                let written = page
                    .and_then(|page| Ok(atomic::write(&path, backlit_report::to_html(&page).as_bytes())?));
                (path, written)
            })
        });
    }

    pub(super) fn is_busy(&self) -> bool {
        self.task.is_busy()
    }

    /// Says what became of a page; its path if it is written.
    pub(super) fn update(&mut self, requests: &mut Requests) -> Option<PathBuf> {
        let mut last = None;
        for (path, written) in requests.outputs("The report", &mut self.task) {
            match written {
                Ok(()) => {
                    let text = format!("Wrote the report {}.", format::file_name(&path));
                    requests.inform(text, Some(Command::Export(ExportCommand::ShowExported)));
                    last = Some(path);
                }
                Err(error) => {
                    let advice = write_advice(error.as_ref());
                    requests.complain(format!("No report: {error:#}. {advice}"));
                }
            }
        }
        last
    }
}
