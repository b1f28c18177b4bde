//! Looking and posing through the real window, by label and role, on a tiny take.

use std::collections::BTreeMap;

use backlit_tracking::body::{Kinematics, Pose};
use backlit_ui::drawing::JointId;
use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, OutputCommand, Rect, vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use glam::DVec2;

use crate::support::window::{
    Window, WindowState, arm, built_in, centre, choose, click, drag, grab, pointer, press, release, settle,
    undo, wheel,
};

const CAMERAS: [&str; 2] = ["Camera 1", "Camera 2"];
const JOINTS: [&str; 3] = ["root", "right elbow", "right wrist"];

fn pose(harness: &Window) -> Pose {
    harness.document().pose_at(0).clone()
}

/// Where all joints are on the screen, in all views.
fn marks(harness: &Window) -> BTreeMap<String, Rect> {
    let labels =
        CAMERAS.iter().flat_map(|camera| JOINTS.iter().map(move |joint| format!("{joint}, {camera}")));
    labels.map(|label| (label.clone(), harness.get_by_label(&label).rect())).collect()
}

/// The second joint of the forearm in the picture of the first camera.
fn wrist_px(harness: &Window) -> DVec2 {
    let model = &harness.document().model;
    let wrist = Kinematics::new(model, &pose(harness)).ends()[1];
    harness.session().take.as_ref().unwrap().cameras[0].project(wrist).unwrap()
}

/// What was placed in one view stays there while the joint is dragged in another.
#[test]
fn a_joint_that_was_placed_in_one_view_stays_there_in_another() {
    let mut window = arm().open();
    drag(&mut window, "right wrist, Camera 1", vec2(-12.0, 25.0));
    let placed = wrist_px(&window);
    drag(&mut window, "right wrist, Camera 2", vec2(10.0, 40.0));
    assert!(wrist_px(&window).distance(placed) < 0.5, "{} and {placed}", wrist_px(&window));
    undo(&mut window);
    undo(&mut window);
    // Undone, nothing holds it.
    let before = wrist_px(&window);
    drag(&mut window, "right wrist, Camera 2", vec2(10.0, 40.0));
    let moved = wrist_px(&window).distance(before);
    assert!(moved > 2.0, "{moved} px");
}

#[test]
fn the_frame_after_a_pointer_move_shows_the_new_pose_in_all_views() {
    let mut harness = arm().open();
    let from = centre(&harness, "right wrist, Camera 1");
    grab(&mut harness, from, &[vec2(0.0, 10.0)]);
    for distance in [25.0, 40.0, 60.0, 45.0] {
        let before = marks(&harness);
        harness.event(Event::PointerMoved(from + vec2(0.0, distance)));
        // The frame that hears of the move, and asks for the next one at once …
        harness.step();
        assert!(harness.ctx.has_requested_repaint());
        // … which shows it, whether or not the worker has drawn the silhouette.
        harness.step();
        let after = marks(&harness);
        for camera in CAMERAS {
            let wrist = format!("right wrist, {camera}");
            assert!(before[&wrist].center().distance(after[&wrist].center()) > 1.0, "{wrist} stands still");
        }
        assert!(after["right wrist, Camera 1"].center().distance(from + vec2(0.0, distance)) < 2.0);
        // Nothing else is waited for: when the worker is done, everything is where it was.
        settle(&mut harness);
        assert_eq!(marks(&harness), after);
        assert_eq!(harness.session().predicted.as_ref().unwrap().pose, pose(&harness));
    }
    release(&mut harness, from);
}

#[test]
fn a_modifier_on_the_way_is_the_same_act() {
    let mut harness = arm().open();
    let before = pose(&harness);
    let from = centre(&harness, "right wrist, Camera 1");
    grab(&mut harness, from, &[vec2(0.0, 20.0)]);
    let dragged = pose(&harness);
    harness.event(Event::ModifiersChanged(Modifiers::SHIFT));
    for height in [10.0, -40.0] {
        harness.event(Event::PointerMoved(from + vec2(0.0, height)));
        harness.step();
    }
    harness.step();
    assert_ne!(pose(&harness), dragged, "the depth changed too");
    harness.event(Event::ModifiersChanged(Modifiers::NONE));
    // The pointer may leave the tile, and the window.
    harness.event(Event::PointerMoved(from + vec2(-900.0, -40.0)));
    harness.step();
    release(&mut harness, from);
    undo(&mut harness);
    assert_eq!(pose(&harness), before);
    assert!(harness.document().keys.is_empty());
}

#[test]
fn limits_are_shown_in_the_views_as_they_are_reached() {
    let mut harness = built_in().open();
    let stops = |harness: &Window| {
        let labels = harness.query_all_by_label_contains(": limit, ");
        labels.filter_map(|node| node.accesskit_node().value()).collect::<Vec<_>>()
    };
    assert_eq!(stops(&harness), [""; 0]);
    // The wrist goes to the shoulder: the elbow cannot bend so far.
    let from = centre(&harness, "right wrist, Camera 1");
    let to = centre(&harness, "right shoulder, Camera 1") - from;
    grab(&mut harness, from, &[to * 0.4, to * 0.7, to, to * 1.05]);
    harness.step();
    let stopped = stops(&harness);
    let is_named = |stop: &String| stop.starts_with("right elbow: limit, ");
    assert!(stopped.iter().any(is_named), "{stopped:?}");
    assert!(stopped.iter().all(|stop| stop.ends_with("Camera 1")), "said once: {stopped:?}");
    release(&mut harness, from + to * 1.05);
    assert_eq!(stops(&harness), [""; 0], "what is let go is not stopped");
    // The sliders of the panel say what they may be, in the views.
    let flexion = harness.get_by_role_and_label(Role::Slider, "Flexion").rect().center();
    harness.event(Event::PointerMoved(flexion));
    harness.run_steps(3);
    assert_eq!(harness.query_all_by_label_contains("right elbow: ").count(), 1);
}

#[test]
fn escape_puts_back_what_a_slider_has_changed() {
    let mut harness = arm().open();
    choose(&mut harness, Role::ListItem, "Right forearm");
    let before = pose(&harness);
    let from = harness.get_by_role_and_label(Role::Slider, "Flexion").rect().center();
    grab(&mut harness, from, &[vec2(12.0, 0.0), vec2(24.0, 0.0)]);
    harness.step();
    assert_ne!(pose(&harness), before);
    press(&mut harness, Modifiers::NONE, Key::Escape);
    assert_eq!(pose(&harness), before);
    release(&mut harness, from + vec2(24.0, 0.0));
    assert_eq!(pose(&harness), before);
}

/// What was copied as text since the last frame.
fn copied(harness: &Window) -> Option<String> {
    harness.output().platform_output.commands.iter().find_map(|command| match command {
        OutputCommand::CopyText(text) => Some(text.clone()),
        _ => None,
    })
}

#[test]
fn a_pose_goes_through_a_text_editor_and_back() {
    let mut harness = arm().open();
    harness.event(Event::Copy);
    harness.step();
    let text = copied(&harness).unwrap();
    assert!(text.contains("backlit-pose 1") && text.contains("right forearm"), "{text}");
    let before = pose(&harness);
    let mut edited: serde_json::Value = serde_json::from_str(&text).unwrap();
    edited["root"][0] = serde_json::json!(before.root.x + 0.25);
    harness.event(Event::Paste(edited.to_string()));
    settle(&mut harness);
    assert!((pose(&harness).root.x - before.root.x - 0.25).abs() < 1e-9, "{}", pose(&harness).root);
    undo(&mut harness);
    assert_eq!(pose(&harness), before);
    harness.event(Event::Paste("{\"format\": \"backlit-pose 1\",\n\"root\": [0, 0]}".to_owned()));
    settle(&mut harness);
    assert_eq!(pose(&harness), before);
    let said = harness.last_said();
    assert!(said.contains("clipboard") && said.contains("The pose is as it was"), "{said}");
    // Without a system's clipboard, the button pastes what was copied here.
    click(&mut harness, "Reset");
    let reset = pose(&harness);
    assert_ne!(reset, before);
    click(&mut harness, "Paste");
    harness.run_steps(6);
    assert!(pose(&harness).local(&before).iter().all(|x| x.abs() < 1e-9));
}

#[test]
fn arrows_nudge_the_joint_and_are_undone_together() {
    let mut harness = arm().open();
    choose(&mut harness, Role::ListItem, "Right forearm");
    let (before, from) = (pose(&harness), wrist_px(&harness));
    let nudge = |harness: &mut Window, modifiers, key| {
        harness.key_press_modifiers(modifiers, key);
        harness.step();
    };
    nudge(&mut harness, Modifiers::COMMAND, Key::ArrowDown);
    assert!(wrist_px(&harness).distance(from + DVec2::new(0.0, 1.0)) < 0.05, "{}", wrist_px(&harness));
    nudge(&mut harness, Modifiers::COMMAND, Key::ArrowDown);
    nudge(&mut harness, Modifiers::COMMAND | Modifiers::SHIFT, Key::ArrowLeft);
    settle(&mut harness);
    let moved = wrist_px(&harness);
    assert!(moved.distance(from + DVec2::new(-5.0, 2.0)) < 0.05, "{from} {moved}");
    undo(&mut harness);
    assert_eq!(pose(&harness), before);
}

#[test]
fn tab_goes_through_the_tree_and_back() {
    let mut harness = arm().open();
    let joint = |harness: &Window| harness.selection().joint;
    let first = joint(&harness);
    press(&mut harness, Modifiers::NONE, Key::Tab);
    assert_eq!(joint(&harness), JointId::End(1));
    press(&mut harness, Modifiers::NONE, Key::Tab);
    assert_eq!(joint(&harness), first);
    press(&mut harness, Modifiers::SHIFT, Key::Tab);
    assert_eq!(joint(&harness), JointId::End(1));
}

#[test]
fn a_refit_says_what_it_did_and_goes_on_saying_it() {
    let mut harness = arm().open();
    harness.get_by_label("No refit of this frame yet");
    choose(&mut harness, Role::ListItem, "Right forearm");
    let upper = pose(&harness).rotations[0];
    click(&mut harness, "Refit limb");
    harness.get_by_label_contains("Refit right forearm: cost fell by ");
    assert!(pose(&harness).rotations[0].angle_between(upper) < 1e-6, "the rest stays");
    click(&mut harness, "Step");
    harness.get_by_label_contains("Refit right forearm: cost fell by ");
    click(&mut harness, "Refit chain");
    harness.get_by_label_contains("Refit chain of right forearm: cost ");
    undo(&mut harness);
    harness.get_by_label_contains("Refit chain of right forearm: cost ");
}

#[test]
fn sizes_are_dragged_in_the_view() {
    let mut harness = arm().open();
    choose(&mut harness, Role::ListItem, "Right forearm");
    let size = |harness: &Window| {
        let limb = &harness.document().model.limbs()[1];
        (limb.length, limb.radius)
    };
    let before = size(&harness);
    assert!(harness.query_by_label("right forearm length, Camera 1").is_none());
    press(&mut harness, Modifiers::NONE, Key::A);
    press(&mut harness, Modifiers::NONE, Key::E);
    let handle = centre(&harness, "right forearm length, Camera 1");
    let along = (handle - centre(&harness, "right wrist, Camera 1")).normalized();
    grab(&mut harness, handle, &[along * 10.0, along * 30.0]);
    harness.step();
    // The end has followed the pointer.
    let moved = centre(&harness, "right forearm length, Camera 1");
    assert!(moved.distance(handle + along * 30.0) < 3.0, "{handle} {moved}");
    release(&mut harness, handle + along * 30.0);
    assert!(size(&harness).0 > before.0 + 0.005 && size(&harness).1 == before.1, "{:?}", size(&harness));
    undo(&mut harness);
    assert_eq!(size(&harness), before);
    let handle = centre(&harness, "right forearm radius, Camera 1");
    let other = centre(&harness, "right forearm radius, other side, Camera 1");
    let out = (handle - other).normalized();
    grab(&mut harness, handle, &[out * 5.0, out * 12.0]);
    harness.step();
    assert!(size(&harness).1 > before.1 + 0.002, "{:?}", size(&harness));
    press(&mut harness, Modifiers::NONE, Key::Escape);
    release(&mut harness, handle);
    assert_eq!(size(&harness), before);
}

#[test]
fn the_body_is_scaled_as_a_whole_and_undone_at_once() {
    let mut harness = arm().open();
    choose(&mut harness, Role::Button, "Size");
    let before = harness.document().model.clone();
    let from = harness.get_by_role_and_label(Role::Slider, "Body").rect().center();
    grab(&mut harness, from, &[vec2(6.0, 0.0), vec2(20.0, 0.0)]);
    release(&mut harness, from + vec2(20.0, 0.0));
    let after = harness.document().model.clone();
    let ratios = after
        .limbs()
        .iter()
        .zip(before.limbs())
        .flat_map(|(after, before)| [after.length / before.length, after.radius / before.radius]);
    let ratios: Vec<f64> = ratios.collect();
    assert!(ratios.iter().all(|ratio| (ratio - ratios[0]).abs() < 1e-9 && *ratio > 1.05), "{ratios:?}");
    undo(&mut harness);
    assert_eq!(*harness.document().model, *before);
}

#[test]
fn each_drag_of_a_weight_is_undone_by_itself() {
    // Wide enough for the gutter beside a picture in landscape format.
    let mut harness = arm().sized(2400.0, 800.0).open();
    let weight = |harness: &Window| harness.document().cameras[1].weight;
    let mut weights = vec![weight(&harness)];
    for by in [10.0, -25.0] {
        let from = harness.get_by_role_and_label(Role::Slider, "Weight of Camera 2").rect().center();
        grab(&mut harness, from, &[vec2(by * 0.5, 0.0), vec2(by, 0.0)]);
        release(&mut harness, from + vec2(by, 0.0));
        weights.push(weight(&harness));
    }
    assert!(weights[1] > 1.0 && weights[2] < 1.0, "{weights:?}");
    undo(&mut harness);
    assert_eq!(weight(&harness), weights[1]);
    undo(&mut harness);
    assert_eq!(weight(&harness), weights[0]);
}

fn shown(harness: &Window, text: &str) -> bool {
    harness.query_by_label(&format!("Camera 1, view mode: {text}")).is_some()
}

#[test]
fn wipe_blink_and_the_jacobians_axis_have_keys() {
    let mut harness = arm().open();
    assert!(shown(&harness, "Tinted overlay on footage"));
    press(&mut harness, Modifiers::NONE, Key::W);
    assert!(shown(&harness, "Tinted overlay on footage | footage"));
    harness.get_by_label("Wipe to footage");
    press(&mut harness, Modifiers::NONE, Key::B);
    assert!(shown(&harness, "Tinted overlay on footage / footage"));
    assert!(harness.query_by_label("Wipe to footage").is_none());
    press(&mut harness, Modifiers::NONE, Key::B);
    assert!(shown(&harness, "Tinted overlay on footage"));
    press(&mut harness, Modifiers::NONE, Key::J);
    assert!(shown(&harness, "Jacobian column, right upper arm about x"));
    let column = |harness: &Window| harness.session().predicted.as_ref().unwrap().scene.derivatives.column;
    let first = column(&harness).unwrap();
    press(&mut harness, Modifiers::NONE, Key::J);
    assert!(shown(&harness, "Jacobian column, right upper arm about y"));
    assert_eq!(column(&harness), Some(first + 1));
}

#[test]
fn views_zoom_by_keys_and_are_moved_by_their_background() {
    let mut harness = arm().open();
    let elbow = |harness: &Window| centre(harness, "right elbow, Camera 1");
    let length = |harness: &Window| elbow(harness).distance(centre(harness, "right wrist, Camera 1"));
    let (before, at) = (length(&harness), elbow(&harness));
    press(&mut harness, Modifiers::NONE, Key::Plus);
    assert!((length(&harness) / before - 1.25).abs() < 0.02, "{before} {}", length(&harness));
    press(&mut harness, Modifiers::NONE, Key::Minus);
    assert!((length(&harness) / before - 1.0).abs() < 0.02);
    let pose_before = pose(&harness);
    let corner = harness.get_by_label("Camera 1 picture").rect().left_top() + vec2(16.0, 40.0);
    let way = [vec2(12.0, 8.0), vec2(30.0, 20.0), vec2(50.0, 30.0)];
    grab(&mut harness, corner, &way);
    harness.step();
    release(&mut harness, corner + way[2]);
    assert!(elbow(&harness).x - at.x > 20.0 && elbow(&harness).y - at.y > 10.0, "{at} {}", elbow(&harness));
    assert_eq!(pose(&harness), pose_before, "the body stays");
    // Every event takes a frame here, and frames take long.
    harness.ctx.options_mut(|options| options.input_options.max_double_click_delay = 10.0);
    for _ in 0..2 {
        harness.event(pointer(corner + way[2], true));
        harness.event(pointer(corner + way[2], false));
        harness.step();
    }
    settle(&mut harness);
    assert!(elbow(&harness).distance(at) < 1.0, "a double click fits the subject");
}

#[test]
fn linked_views_zoom_about_the_same_point_of_the_body() {
    let mut harness = arm().open();
    press(&mut harness, Modifiers::NONE, Key::Z);
    let at = centre(&harness, "right elbow, Camera 1");
    let other = centre(&harness, "right elbow, Camera 2");
    let length = |harness: &Window| {
        centre(harness, "right elbow, Camera 2").distance(centre(harness, "right wrist, Camera 2"))
    };
    let before = length(&harness);
    harness.event(Event::PointerMoved(at));
    harness.step();
    harness.event(wheel(vec2(0.0, 60.0)));
    harness.run_steps(30);
    assert!(length(&harness) > 1.15 * before, "{before} {}", length(&harness));
    let moved = centre(&harness, "right elbow, Camera 2").distance(other);
    // The pointer is on the elbow's skin, not in its middle.
    assert!(moved < 8.0, "{moved}");
}
