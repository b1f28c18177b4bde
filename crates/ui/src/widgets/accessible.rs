//! Where the widgets are, by the names that screen readers call them by: for the tour and for the exported state.

use std::collections::HashMap;

use egui::accesskit::{Node, NodeId, Role, Toggled, TreeUpdate};
use egui::{Context, FullOutput, Pos2, Rect, vec2};
use serde_json::{Value, json};

/// A widget that has a name.
#[derive(Debug, Clone, PartialEq)]
pub struct Named {
    /// What screen readers call it.
    pub name: String,
    /// What kind of widget it is.
    pub role: Role,
    /// Points of the window.
    pub rect: Rect,
    /// Its value, if it has one: a number, a text, or whether it is on.
    pub value: Option<Value>,
    /// Whether it takes no input now.
    pub is_disabled: bool,
}

/// The named widgets of the last frame, kept by egui's context.
#[derive(Debug, Default)]
pub struct Names(Vec<Named>);

impl Names {
    /// The first widget, in the order of the tree, of which `is` says yes.
    pub fn find(ctx: &Context, is: impl Fn(&Named) -> bool) -> Option<Rect> {
        let names = ctx.plugin_opt::<Self>()?;
        names.lock().0.iter().find(|named| is(named)).map(|named| named.rect)
    }

    /// Begins to keep the names, if nobody has begun yet.
    pub fn keep(ctx: &Context) {
        if ctx.plugin_opt::<Self>().is_none() {
            ctx.enable_accesskit();
            ctx.add_plugin(Self::default());
            ctx.request_repaint();
        }
    }
}

impl egui::Plugin for Names {
    fn debug_name(&self) -> &'static str {
        "names of widgets"
    }

    fn output_hook(&mut self, _ctx: &Context, output: &mut FullOutput) {
        if let Some(update) = &output.platform_output.accesskit_update {
            self.0 = named(update);
        }
    }
}

/// The nodes that have a name, in the order of the tree.
pub fn named(update: &TreeUpdate) -> Vec<Named> {
    let nodes: HashMap<NodeId, &Node> = update.nodes.iter().map(|(id, node)| (*id, node)).collect();
    let Some(tree) = &update.tree else { return Vec::new() };
    let mut named = Vec::new();
    let mut rest = vec![tree.root];
    while let Some(id) = rest.pop() {
        let Some(node) = nodes.get(&id) else { continue };
        rest.extend(node.children().iter().rev());
        if let (Some(name), Some(bounds), false) = (name_of(node, &nodes), node.bounds(), node.is_hidden()) {
            let corner = Pos2::new(bounds.x0 as f32, bounds.y0 as f32);
            let rect = Rect::from_min_size(corner, vec2(bounds.width() as f32, bounds.height() as f32));
            let (role, value, is_disabled) = (node.role(), value_of(node), node.is_disabled());
            named.push(Named { name, role, rect, value, is_disabled });
        }
    }
    named
}

/// What a node is called: by itself, by the nodes that label it, or by its own text.
fn name_of(node: &Node, nodes: &HashMap<NodeId, &Node>) -> Option<String> {
    let own = |node: &Node| node.label().or_else(|| node.value()).map(str::to_owned);
    let labels = || {
        let texts: Vec<String> =
            node.labelled_by().iter().filter_map(|id| nodes.get(id).and_then(|node| own(node))).collect();
        (!texts.is_empty()).then(|| texts.join(" "))
    };
    let text = || (node.role() == Role::Label).then(|| own(node)).flatten();
    node.label().map(str::to_owned).or_else(labels).or_else(text).filter(|name| !name.is_empty())
}

fn value_of(node: &Node) -> Option<Value> {
    let toggled = node.toggled().map(|toggled| json!(toggled == Toggled::True));
    let number = || node.numeric_value().map(|value| json!(value));
    let selected = || node.is_selected().map(|selected| json!(selected));
    let text = || node.value().filter(|_| node.role() != Role::Label).map(|text| json!(text));
    toggled.or_else(selected).or_else(number).or_else(text)
}
