//! Everything that can be clicked, dragged or typed into has a name that a screen reader can say.

use backlit::context::preferences::Layout;
use egui::accesskit::{Action, Role};
use egui::{Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable, by};

use crate::support::window::{Window, arm, click, command, empty, press, settle};

/// Width of the gap between tiles that can be grabbed.
const GAP: f64 = 10.0;

fn open(layout: Layout) -> Window {
    let setup = arm().layout(layout).sized(1600.0, 1000.0);
    setup.with(|options| options.offers_tour = true).open()
}

/// Why the name of an input, a picture or a plot is none. A hint in an empty field is not a name: it is gone once
/// something is typed. Nor is what was chosen or typed.
fn misnamed(node: &egui_kittest::kittest::AccessKitNode<'_>) -> Option<String> {
    const NAMED: [Role; 14] = [
        Role::TextInput,
        Role::MultilineTextInput,
        Role::SearchInput,
        Role::NumberInput,
        Role::SpinButton,
        Role::Slider,
        Role::ComboBox,
        Role::CheckBox,
        Role::RadioButton,
        Role::Button,
        Role::Image,
        Role::Canvas,
        Role::GraphicsSymbol,
        Role::ListBox,
    ];
    let is_read_only = node.data().is_read_only();
    if !NAMED.contains(&node.role()) || node.is_hidden() || is_read_only {
        return None;
    }
    let name = node.label().unwrap_or_default();
    if name.trim().is_empty() {
        return Some(match node.data().placeholder() {
            Some(hint) => format!("has only the hint {hint:?}"),
            None => "has no name".to_owned(),
        });
    }
    let is_value = matches!(node.role(), Role::ComboBox | Role::SpinButton | Role::TextInput)
        && node.value().is_some_and(|value| value == name);
    is_value.then(|| format!("is called by its value {name:?}"))
}

/// Adds the nodes without a name to the list: those with a role that asks for one, and those that can be clicked.
fn look_around(harness: &Window, place: &str, unnamed: &mut Vec<String>) {
    let mut add = |text: String| {
        let text = format!("{place}: {text}");
        if !unnamed.contains(&text) {
            unnamed.push(text);
        }
    };
    harness.unnamed_widgets().into_iter().for_each(&mut add);
    for node in harness.query_all(by().predicate(|_| true)) {
        let node = node.accesskit_node();
        if let Some(why) = misnamed(&node) {
            add(format!("{:?} at {:?} {why}", node.role(), node.bounding_box()));
        }
        let is_clickable = node.data().supports_action(Action::Click);
        // Scroll bars and the gaps between tiles are the libraries' own; keys do the same.
        let is_gap = node.role() == Role::Unknown
            && node.bounding_box().is_some_and(|at| at.width().min(at.height()) <= GAP);
        if node.role() == Role::ScrollBar || is_gap {
            continue;
        }
        let has_role = !matches!(node.role(), Role::Unknown | Role::GenericContainer);
        if is_clickable && !has_role {
            add(format!("{:?} at {:?} can be clicked", node.role(), node.bounding_box()));
        }
    }
}

/// Opens everything that is shut.
fn open_sections(harness: &mut Window) {
    for title in
        ["Refit", "Size", "Measurement", "Renderer", "Solver", "Observability", "Camera subsets", "Basin"]
    {
        let sections = harness.query_all_by_role_and_label(Role::Button, title).count();
        if sections == 1 {
            click(harness, title);
        }
    }
}

#[test]
fn panels_of_every_layout_have_names() {
    let mut unnamed = Vec::new();
    for (layout, name) in Layout::ALL {
        let mut harness = open(layout);
        look_around(&harness, name, &mut unnamed);
        open_sections(&mut harness);
        look_around(&harness, &format!("{name}, all sections"), &mut unnamed);
        if layout != Layout::Demonstrate {
            click(&mut harness, "Step");
            click(&mut harness, "Track forward");
            look_around(&harness, &format!("{name}, tracked"), &mut unnamed);
        }
    }
    let empty = empty().sized(1100.0, 700.0).open();
    look_around(&empty, "empty", &mut unnamed);
    assert!(unnamed.is_empty(), "{unnamed:#?}");
}

#[test]
fn cards_and_menus_have_names() {
    let mut unnamed = Vec::new();
    let mut harness = open(Layout::Pose);
    for key in [Key::K, Key::E] {
        press(&mut harness, Modifiers::COMMAND, key);
        look_around(&harness, &format!("Ctrl+{key:?}"), &mut unnamed);
        press(&mut harness, Modifiers::NONE, Key::Escape);
    }
    press(&mut harness, Modifiers::NONE, Key::Questionmark);
    look_around(&harness, "keys", &mut unnamed);
    press(&mut harness, Modifiers::NONE, Key::Escape);
    for name in ["about backlit", "messages", "export steps"] {
        command(&mut harness, name);
        look_around(&harness, name, &mut unnamed);
        press(&mut harness, Modifiers::NONE, Key::Escape);
    }
    for menu in ["File", "Edit", "View", "Fit", "Track", "Demonstrate", "Help"] {
        harness.get_all_by_role_and_label(Role::Button, menu).next().unwrap().click();
        settle(&mut harness);
        look_around(&harness, &format!("menu {menu}"), &mut unnamed);
        press(&mut harness, Modifiers::NONE, Key::Escape);
    }
    assert!(unnamed.is_empty(), "{unnamed:#?}");
}

/// The names of a window of a few widgets are judged; `true` where something is found.
fn finds(add: impl FnMut(&mut egui::Ui)) -> bool {
    let harness = Harness::builder().with_accessibility_check(false).build_ui(add);
    let mut found = harness.unnamed_widgets();
    let nodes = harness.query_all(by().predicate(|_| true));
    found.extend(nodes.filter_map(|node| misnamed(&node.accesskit_node())));
    !found.is_empty()
}

/// The check can fail.
#[test]
fn widgets_without_names_are_found() {
    let mut text = String::new();
    assert!(finds(|ui| drop(ui.add(egui::Button::new("")))));
    assert!(finds(|ui| drop(ui.add(egui::TextEdit::singleline(&mut text).hint_text("Search")))));
    assert!(finds(|ui| drop(ui.add(egui::DragValue::new(&mut 1.0)))));
    assert!(finds(|ui| drop(ui.add(egui::Slider::new(&mut 1.0, 0.0..=2.0)))));
    assert!(finds(|ui| drop(ui.add(egui::Checkbox::without_text(&mut true)))));
    assert!(finds(|ui| drop(egui::ComboBox::from_id_salt("box").selected_text("1×").show_ui(ui, |_| ()))));
    let mut text = "typed".to_owned();
    assert!(!finds(|ui| drop(backlit_ui::widgets::text_field(ui, "Find", "Search", &mut text))));
    let mut text = String::new();
    assert!(!finds(|ui| drop(backlit_ui::widgets::text_field(ui, "Find", "Search", &mut text))));
}
