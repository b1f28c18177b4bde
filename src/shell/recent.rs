//! Takes and projects that were opened last, in the File menu and on the empty screen.

use std::path::Path;

use backlit_ui::style::theme::size;
use backlit_ui::widgets::{Icon, hint, icon_button};
use egui::{Id, Ui};

use crate::context::{Context, DesktopRequest, Requests, ShellRequest};

/// How long it is believed that a file is still there, in seconds: asking may take time on some disks.
const BELIEVED: f64 = 5.0;

/// A row for each. Those that are not there any more are grey and say so. Returns whether one was chosen.
pub(crate) fn rows(ui: &mut Ui, context: &Context<'_>, requests: &mut Requests, is_menu: bool) -> bool {
    let mut is_chosen = false;
    for path in &context.preferences.recent {
        let is_there = is_there(ui, path);
        let name = path.file_name().map_or_else(|| path.to_string_lossy(), |name| name.to_string_lossy());
        let row = |ui: &mut Ui| {
            let response = ui.add_enabled_ui(is_there, |ui| {
                if is_menu { ui.button(name.as_ref()) } else { ui.link(name.as_ref()) }
            });
            let hover = if is_there {
                path.display().to_string()
            } else {
                format!("{}\nIt is not there any more.", path.display())
            };
            response.inner.on_hover_text(&hover).on_disabled_hover_text(hover).clicked()
        };
        let forget = |ui: &mut Ui| {
            let label = format!("Remove {name} from the recent takes");
            icon_button(ui, Icon::Close, &label, "Remove it from this list; nothing is deleted").clicked()
        };
        let (opens, forgets) = if is_there {
            (row(ui), false)
        } else {
            // As wide as it is about to be, so that it stands in the middle where rows do.
            let room = egui::vec2(if is_menu { ui.available_width() } else { 170.0 }, size::BUTTON);
            let direction = egui::Layout::left_to_right(egui::Align::Center);
            let shown = ui.allocate_ui_with_layout(room, direction, |ui| {
                let opens = row(ui);
                hint(ui, "missing");
                (opens, forget(ui))
            });
            shown.inner
        };
        if opens {
            requests.request(DesktopRequest::OpenPath(path.clone()));
        }
        if forgets {
            requests.request(ShellRequest::ForgetRecent(path.clone()));
        }
        is_chosen |= opens;
    }
    is_chosen
}

/// Whether a file or folder is there, as far as is known.
fn is_there(ui: &Ui, path: &Path) -> bool {
    let id = Id::unique(("is there", path));
    let now = ui.input(|input| input.time);
    let known: Option<(bool, f64)> = ui.data(|data| data.get_temp(id));
    if let Some((is_there, _)) = known.filter(|(_, at)| (0.0..BELIEVED).contains(&(now - at))) {
        return is_there;
    }
    let is_there = path.exists();
    ui.data_mut(|data| data.insert_temp(id, (is_there, now)));
    is_there
}
