//! A camera's tile: one small picture a view mode, and what it says the user did.

use crate::support;
use backlit::context::view_settings::ViewSettings;
use backlit::features::camera_views as camera_tile;
use backlit::features::camera_views::{
    BodyMarks, Ellipses, SteeredSilhouette, TileEvent, TileInput, TileView,
};
use backlit_tracking::body::builtin::full_body;
use backlit_tracking::body::{JointAngles, Kinematics, Model, Parameters, Pose};
use backlit_tracking::camera::{Camera, CameraFromWorld, Distortion, Intrinsics};
use backlit_tracking::observability::ImageEllipse;
use backlit_tracking::posing::LimitedAngle;
use backlit_tracking::render::{BodyMotion, DrawOptions, Prediction, Ramp, RendererKind, View, predict};
use backlit_tracking::silhouette::{Label, Mask, Measurement, Overlap, SignedDistance};
use backlit_ui::drawing::{
    BoundedAngle, Derivative, Drag, DragEvent, JointEllipse, JointId, JointMark, LimitMark, ModeComparison,
    PictureInput, SightRay, ViewMode, body_outline, limb_colours, project_joints, project_limbs, sight_ray,
};
use backlit_ui::style::theme::Theme;
use backlit_ui::widgets::Framing;
use egui::{Color32, Event, Key, Modifiers, PointerButton, Pos2, Rect, Role, Vec2, pos2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use glam::{DQuat, DVec2, DVec3};
use image::{Rgb, RgbImage};

use crate::support::snapshots::{Snapshots, theme_name};
use crate::support::window::{button, wheel};

const SIZE: [usize; 2] = [136, 240];

/// A made-up camera, a body at rest in it, and data of the same body with one arm raised.
struct Scene {
    body: Model,
    camera: Camera,
    other_camera: Camera,
    frame: RgbImage,
    mask: Mask,
    data: Measurement,
    prediction: Prediction,
    view: View,
    gradient: Derivative,
    jacobian: Derivative,
    colours: Vec<Color32>,
    outlines: Vec<Vec<DVec2>>,
    /// Limbs alone, and with their joints.
    plain: BodyMarks,
    posed: BodyMarks,
    overlap: Overlap,
    wrist: JointId,
}

fn camera(centre: DVec3) -> Camera {
    let intrinsics = Intrinsics { fx: 300.0, fy: 300.0, cx: 67.5, cy: 119.5 };
    let place = CameraFromWorld::looking_at(centre, DVec3::new(0.0, 0.0, 1.0), DVec3::Z);
    let size = SIZE.map(|side| side as u64);
    Camera::new("camera", size, intrinsics, Distortion::None, place).unwrap()
}

fn silhouette(prediction: &Prediction) -> Mask {
    let label = |lambda: &f32| if *lambda < 127.5 { Label::Subject } else { Label::Background };
    let mut labels: Vec<Label> = prediction.lambda.iter().map(label).collect();
    // Nobody can tell what is behind the feet.
    for y in 205..225 {
        labels[y * SIZE[0] + 30..y * SIZE[0] + 100].fill(Label::Unknown);
    }
    Mask::new(SIZE[0], SIZE[1], labels).unwrap()
}

impl Scene {
    fn new() -> Self {
        let body = full_body();
        let camera = camera(DVec3::new(0.6, 3.2, 1.2));
        let other_camera = self::camera(DVec3::new(3.0, 0.8, 1.3));
        let mut pose = Pose::rest(&body);
        pose.root = DVec3::new(0.0, 0.0, 1.0);
        let mut raised = pose.clone();
        for (limb, angle) in [("right upper arm", 0.9), ("left thigh", -0.25)] {
            let rotation = body.limbs()[body.limb_index(limb).unwrap()].rotation;
            raised.rotations[rotation] = DQuat::from_rotation_y(angle);
        }
        let draw = |pose: &Pose| {
            let kinematics = Kinematics::new(&body, pose);
            predict(&body, &kinematics, &camera, RendererKind::Capsule, Ramp::Half)
        };
        let mask = silhouette(&draw(&raised));
        let distance = SignedDistance::from_mask(&mask);
        let data = Measurement::from_distance(&distance, &mask, 2.0, 4.0).unwrap();
        let prediction = draw(&pose);
        let kinematics = Kinematics::new(&body, &pose);
        let view = View::new(&body, &kinematics, &camera, RendererKind::Capsule, Ramp::Half);
        // The subject's left thigh swings sideways.
        let thigh = body.limbs()[body.limb_index("left thigh").unwrap()].rotation;
        let column = Parameters::Tangent.first_column(thigh) + 1;
        let mut direction = vec![0.0; Parameters::Tangent.columns(body.rotation_count())];
        direction[column] = 1.0;
        let motion = BodyMotion::along(&kinematics, &camera, Parameters::Tangent, &direction);
        let drawing =
            backlit_tracking::render::draw(&view, DrawOptions { gradient: true, motion: Some(&motion) });
        let limbs = project_limbs(&body, &kinematics, &camera, RendererKind::Capsule);
        let plain = BodyMarks { limbs, ..BodyMarks::default() };
        let foot = JointId::End(body.limb_index("left foot").unwrap());
        Self {
            frame: RgbImage::from_fn(SIZE[0] as u32, SIZE[1] as u32, |x, y| {
                let checker = if (x / 17 + y / 20) % 2 == 0 { 30 } else { 0 };
                Rgb([(90 + y / 3) as u8 + checker, (100 + x / 4) as u8 + checker, 120 + checker])
            }),
            outlines: body_outline(&prediction),
            posed: BodyMarks {
                joints: project_joints(&body, &kinematics, pose.root, &camera, |joint| joint == foot),
                ..plain.clone()
            },
            plain,
            overlap: Overlap::between(&mask, &prediction.lambda).unwrap(),
            colours: limb_colours(&body),
            gradient: Derivative::new(drawing.gradient),
            jacobian: Derivative::new(drawing.change),
            wrist: JointId::End(body.limb_index("right forearm").unwrap()),
            body,
            camera,
            other_camera,
            mask,
            data,
            prediction,
            view,
        }
    }

    fn input(&self, mode: ViewMode) -> TileInput<'_> {
        TileInput {
            index: 0,
            is_active: false,
            is_expanded: false,
            siblings: &[],
            is_linked: true,
            is_calibrated: true,
            tile: TileView { mode, ..TileView::default() },
            settings: ViewSettings::default(),
            subject_px: Some(Rect::from_min_max(pos2(20.0, 25.0), pos2(115.0, 222.0))),
            picture: PictureInput {
                size: SIZE,
                frame: Some(&self.frame),
                mask: Some(&self.mask),
                data: Some(&self.data),
                prediction: Some(&self.prediction),
                view: Some(&self.view),
                gradient: Some(&self.gradient),
                jacobian: Some(&self.jacobian),
                limb_colours: &self.colours,
            },
            full: None,
            generation: 1,
            camera: Some(&self.camera),
            raw_camera: Some(&self.camera),
            body: &self.body,
            sized: None,
            outlines: &self.outlines,
            marks: &self.plain,
            selected: None,
            says_limits: true,
            overlap: Some(self.overlap),
            is_overlap_stale: false,
            is_used: true,
            weight: 1.0,
            held: &[],
            doubts: &[],
            keypoints: &[],
            composed: &[],
            has_unknown_and_shadow: None,
            is_behind: false,
            steered: SteeredSilhouette::default(),
            shows_hover_card: false,
        }
    }

    fn posing(&self) -> TileInput<'_> {
        TileInput {
            marks: &self.posed,
            selected: Some(self.wrist),
            is_active: true,
            ..self.input(ViewMode::Tinted)
        }
    }

    fn joint(&self, joint: JointId) -> &JointMark {
        self.posed.joints.iter().find(|mark| mark.id == joint).unwrap()
    }

    /// The right elbow, bent as far as it goes.
    fn limit_of_elbow(&self) -> LimitMark {
        let forearm = self.body.limb_index("right forearm").unwrap();
        let limb = &self.body.limbs()[forearm];
        let mut pose = Pose::rest(&self.body);
        pose.root = DVec3::new(0.0, 0.0, 1.0);
        let flexion = limb.limits.unwrap().flexion.1;
        let angles = JointAngles { flexion, ..JointAngles::default() };
        pose.rotations[limb.rotation] = limb.rotation_from_angles(angles);
        let kinematics = Kinematics::new(&self.body, &pose);
        let bounded = BoundedAngle::new(&self.body, &pose, forearm, LimitedAngle::Flexion).unwrap();
        LimitMark::new(&self.body, &pose, &kinematics, &self.camera, &bounded).unwrap()
    }

    /// All joints known equally well.
    fn ellipses(&self) -> Vec<JointEllipse> {
        let one = |joint: &JointMark| JointEllipse {
            joint: joint.id,
            ellipse: ImageEllipse {
                centre: joint.px,
                half_axes: [DVec2::new(0.25, 0.1), DVec2::new(-0.05, 0.12)],
                unseen: Vec::new(),
            },
            deviations_m: [0.0023, 0.0061],
            text: format!("{}: ±2.3 mm across, ±6.1 mm in depth (1σ)", joint.name),
        };
        self.posed.joints.iter().map(one).collect()
    }

    fn ray(&self) -> SightRay {
        let elsewhere = sight_ray_target(self);
        sight_ray(&self.other_camera, 1, elsewhere.0, elsewhere.1, &self.camera).unwrap()
    }
}

fn wipe(mode: ViewMode, other: ViewMode, wipe_at: f32) -> TileView {
    TileView { mode, other, comparison: Some(ModeComparison::Wipe), wipe_at, ..TileView::default() }
}

/// The held wrist as the other camera sees it: pixel and depth.
fn sight_ray_target(scene: &Scene) -> (DVec2, f64) {
    let wrist = scene.joint(scene.wrist);
    let ray = scene.camera.ray_in_camera(wrist.px).unwrap();
    let point_in_camera = ray * (wrist.depth_m / ray.z);
    let place = scene.camera.camera_from_world();
    let point = place.rotation.transpose() * (point_in_camera - place.translation);
    (scene.other_camera.project(point).unwrap(), scene.other_camera.depth(point))
}

type Events = Vec<TileEvent>;

fn driven<'a>(input: TileInput<'a>, size: [f32; 2], theme: Theme) -> Harness<'a, Events> {
    support::harness_builder(size, theme).build_ui_state(
        move |ui, events: &mut Events| events.extend(camera_tile::camera_tile(ui, &input).events),
        Events::new(),
    )
}

/// A tile at rest.
fn shown<'a>(input: TileInput<'a>, size: [f32; 2], theme: Theme) -> Harness<'a, Events> {
    let mut harness = driven(input, size, theme);
    harness.run();
    harness
}

const WIDE: [f32; 2] = [376.0, 276.0];
const NARROW: [f32; 2] = [256.0, 276.0];

#[test]
fn view_modes_in_a_narrow_tile() {
    let scene = Scene::new();
    let mut snapshots = Snapshots::default();
    for (mode, theme) in ViewMode::ALL.into_iter().flat_map(|mode| Theme::ALL.map(|theme| (mode, theme))) {
        let mut harness = shown(scene.input(mode), NARROW, theme);
        let name = serde_json::to_string(&mode).unwrap();
        let name = name.trim_matches('"').replace('-', "_");
        snapshots.picture(&harness.render().unwrap(), &format!("camera_tile_{name}_{}", theme_name(theme)));
    }
}

#[test]
fn calibration_size_handles_and_large_pixels() {
    let scene = Scene::new();
    let raw_lens = Distortion::OpenCv { k1: -0.3, k2: 0.0, p1: 0.0, p2: 0.0, k3: 0.0 };
    let (size, intrinsics) = (SIZE.map(|side| side as u64), *scene.camera.intrinsics());
    let raw = Camera::new("camera", size, intrinsics, raw_lens, *scene.camera.camera_from_world()).unwrap();
    let mut snapshots = Snapshots::default();
    let mut shot = |input: TileInput<'_>, name: &str| {
        let mut harness = shown(input, NARROW, Theme::Dark);
        snapshots.picture(&harness.render().unwrap(), name);
    };
    let marks = ViewSettings { calibration_marks: true, ..ViewSettings::default() };
    let tile = TileView { framing: Framing::Whole, mode: ViewMode::Footage, ..TileView::default() };
    let (plain, nobody) = (scene.input(ViewMode::Footage), BodyMarks::default());
    let marked =
        TileInput { settings: marks, tile, raw_camera: Some(&raw), marks: &nobody, outlines: &[], ..plain };
    shot(marked, "camera_tile_calibration");
    let handles = ViewSettings { size_handles: true, ..ViewSettings::default() };
    let thigh = scene.body.limb_index("left thigh").unwrap();
    shot(TileInput { settings: handles, sized: Some(thigh), ..scene.posing() }, "camera_tile_size_handles");
    let framing = Framing::Free { zoom: 16.0, offset: [-0.12, -0.12] };
    let near = TileView { framing, ..scene.posing().tile };
    shot(TileInput { tile: near, ..scene.posing() }, "camera_tile_pixel_grid");
}

#[test]
fn sizes_are_dragged_by_their_handles() {
    let scene = Scene::new();
    let forearm = scene.body.limb_index("left forearm").unwrap();
    let settings = ViewSettings { size_handles: true, ..ViewSettings::default() };
    let framing = Framing::Free { zoom: 3.0, offset: [0.08, 0.0] };
    let tile = TileView { framing, ..scene.posing().tile };
    let input = TileInput { settings, tile, sized: Some(forearm), ..scene.posing() };
    let mut harness = shown(input, WIDE, Theme::Dark);
    for (label, is_length) in
        [("left forearm length, Camera 1", true), ("left forearm radius, Camera 1", false)]
    {
        let handle = centre(&harness, label);
        grab(&mut harness, handle, vec2(9.0, 0.0));
        harness.get_by_label("Esc: put back");
        let_go(&mut harness, handle + vec2(9.0, 0.0));
        let events = taken(&mut harness);
        let is_drag = |event: &TileEvent| match event {
            TileEvent::Drag(DragEvent::Begin(Drag::Length { limb, .. })) => is_length && *limb == forearm,
            TileEvent::Drag(DragEvent::Begin(Drag::Radius { limb, .. })) => !is_length && *limb == forearm,
            _ => false,
        };
        assert!(events.iter().any(is_drag), "{label}: {events:?}");
    }
}

#[test]
fn the_hover_card_is_held_by_a_key() {
    let scene = Scene::new();
    let tile = TileView { mode: ViewMode::Gradient, ..TileView::default() };
    let input = TileInput { shows_hover_card: true, tile, ..scene.input(ViewMode::Gradient) };
    let mut harness = driven(input, [416.0, 276.0], Theme::Dark);
    hover(&mut harness, pos2(122.0, 186.0));
    let title = |harness: &Harness<'_, Events>| {
        harness.get_by_label_contains("Pixel ").accesskit_node().value().unwrap_or_default()
    };
    for label in
        ["Data D ", "Prediction Λ ", "Residual D − Λ ", "Owner ", "d / r ", "Distance ", "Pull, grey 0 / m"]
    {
        harness.get_by_label_contains(label);
    }
    let first = title(&harness);
    harness.key_down(Key::H);
    hover(&mut harness, pos2(140.0, 120.0));
    assert_eq!(title(&harness), first);
    harness.key_up(Key::H);
    harness.run();
    assert_ne!(title(&harness), first);
}

#[test]
fn posing_with_a_gutter_in_both_themes() {
    let scene = Scene::new();
    let mut snapshots = Snapshots::default();
    for theme in Theme::ALL {
        let mut harness = shown(scene.posing(), WIDE, theme);
        snapshots.picture(&harness.render().unwrap(), &format!("camera_tile_posing_{}", theme_name(theme)));
    }
}

#[test]
fn sight_ray_wipe_hover_card_and_empty_tiles() {
    let scene = Scene::new();
    let with_ray = BodyMarks { sight_ray: Some(scene.ray()), ..scene.posed.clone() };
    let nobody = BodyMarks::default();
    let mut snapshots = Snapshots::default();
    let mut shot = |input: TileInput<'_>, size, theme, pointer: Option<Pos2>, name: &str| {
        let mut harness = shown(input, size, theme);
        if let Some(at) = pointer {
            hover(&mut harness, at);
        }
        snapshots.picture(&harness.render().unwrap(), name);
    };
    let with_ray = TileInput { marks: &with_ray, is_active: false, ..scene.posing() };
    shot(with_ray, WIDE, Theme::Dark, None, "camera_tile_sight_ray");
    let wiped = TileInput {
        tile: wipe(ViewMode::ReportOverlay, ViewMode::Footage, 0.55),
        ..scene.input(ViewMode::ReportOverlay)
    };
    shot(wiped, [316.0, 336.0], Theme::Dark, None, "camera_tile_wipe");
    for theme in Theme::ALL {
        let hovered = TileInput { shows_hover_card: true, ..scene.input(ViewMode::Residual) };
        let name = format!("camera_tile_hover_card_{}", theme_name(theme));
        shot(hovered, [416.0, 276.0], theme, Some(pos2(122.0, 186.0)), &name);
    }
    let empty = TileInput {
        picture: PictureInput::empty(SIZE),
        overlap: None,
        outlines: &[],
        marks: &nobody,
        ..scene.input(ViewMode::Tinted)
    };
    shot(empty, WIDE, Theme::Light, None, "camera_tile_empty");
    let strange = TileInput { is_calibrated: false, overlap: None, ..empty };
    shot(strange, NARROW, Theme::Dark, None, "camera_tile_not_calibrated");
}

#[test]
fn limits_ellipses_and_what_is_compared() {
    let scene = Scene::new();
    let mut snapshots = Snapshots::default();
    let mut shot = |harness: &mut Harness<'_, Events>, name: &str| {
        harness.run_steps(2);
        snapshots.picture(&harness.render().unwrap(), name);
    };
    let marks = BodyMarks { limits: vec![scene.limit_of_elbow()], ..scene.posed.clone() };
    let mut stopped = driven(TileInput { marks: &marks, ..scene.posing() }, WIDE, Theme::Dark);
    shot(&mut stopped, "camera_tile_limit");
    stopped.get_by_label_contains("right elbow: limit, flexion ");

    let ellipses = Ellipses { joints: scene.ellipses(), factor: 20, ..Ellipses::default() };
    let marks = BodyMarks { ellipses, ..scene.posed.clone() };
    let observed = TileInput { marks: &marks, shows_hover_card: true, ..scene.posing() };
    let mut known = driven(observed, WIDE, Theme::Dark);
    shot(&mut known, "camera_tile_ellipses");
    known.get_by_label_contains("Uncertainty, 2σ, drawn ×20");
    let wrist = centre(&known, "left wrist, Camera 1");
    hover(&mut known, wrist);
    for label in ["Left wrist", "Across, 1σ ±2.3 mm", "In depth, 1σ ±6.1 mm"] {
        assert!(known.query_all_by_label_contains(label).next().is_some(), "{label}");
    }

    let tile =
        TileView { comparison: Some(ModeComparison::Blink), ..wipe(ViewMode::Residual, ViewMode::Data, 0.5) };
    let mut blinking = driven(TileInput { tile, ..scene.input(ViewMode::Residual) }, WIDE, Theme::Dark);
    shot(&mut blinking, "camera_tile_blink");
    // Both are explained at once: nothing jumps.
    blinking.get_by_label_contains("Legend: Residual:, Missing −255 to 255 spurious, Data:, Subject 0");
}

/// Everything the tile has said since the last call.
fn taken(harness: &mut Harness<'_, Events>) -> Events {
    std::mem::take(harness.state_mut())
}

/// One of the things that the tile has said since the last call is such.
#[track_caller]
fn expect(harness: &mut Harness<'_, Events>, is: impl Fn(&TileEvent) -> bool) -> Events {
    let events = taken(harness);
    assert!(events.iter().any(is), "{events:?}");
    events
}

fn hover(harness: &mut Harness<'_, Events>, at: Pos2) {
    harness.hover_at(at);
    harness.run();
}

fn hold(harness: &mut Harness<'_, Events>, at: Pos2) {
    harness.drag_at(at);
    harness.run();
}

fn let_go(harness: &mut Harness<'_, Events>, at: Pos2) {
    harness.drop_at(at);
    harness.run();
}

/// Presses on a place and moves; the button stays down.
fn grab(harness: &mut Harness<'_, Events>, from: Pos2, by: Vec2) {
    hover(harness, from);
    hold(harness, from);
    hover(harness, from + by);
}

fn centre(harness: &Harness<'_, Events>, label: &str) -> Pos2 {
    harness.get_by_label(label).rect().center()
}

#[test]
fn a_joint_is_dragged_by_its_handle() {
    let scene = Scene::new();
    let mut harness = shown(scene.posing(), WIDE, Theme::Dark);
    let wrist = centre(&harness, "right wrist, Camera 1");
    hover(&mut harness, wrist);
    harness.get_by_label("Right wrist");
    hold(&mut harness, wrist);
    assert_eq!(taken(&mut harness), [TileEvent::Activate, TileEvent::SelectJoint(scene.wrist)]);
    hover(&mut harness, wrist + vec2(20.0, 0.0));
    let events = taken(&mut harness);
    let Some(TileEvent::Drag(DragEvent::Begin(Drag::Joint { joint, target_px }))) =
        events.iter().find(|event| matches!(event, TileEvent::Drag(DragEvent::Begin(_))))
    else {
        panic!("{events:?}")
    };
    let start = scene.joint(scene.wrist).px;
    assert_eq!(*joint, scene.wrist);
    assert!(target_px.x > start.x + 5.0 && (target_px.y - start.y).abs() < 1e-3, "{target_px} from {start}");
    harness.get_by_label("Dragging right wrist");
    harness.get_by_label("Esc: put back");
    Snapshots::default().picture(&harness.render().unwrap(), "camera_tile_dragging");
    let_go(&mut harness, wrist + vec2(20.0, 0.0));
    assert!(taken(&mut harness).contains(&TileEvent::Drag(DragEvent::End)));
}

#[test]
fn escape_cancels_a_drag_and_shift_changes_the_depth() {
    let scene = Scene::new();
    let mut harness = shown(scene.posing(), WIDE, Theme::Dark);
    let wrist = centre(&harness, "right wrist, Camera 1");
    hover(&mut harness, wrist);
    hold(&mut harness, wrist);
    harness.event(Event::ModifiersChanged(Modifiers::SHIFT));
    hover(&mut harness, wrist - vec2(0.0, 40.0));
    let deeper = |event: &TileEvent| matches!(event, TileEvent::Drag(DragEvent::Begin(Drag::Depth { ratio, .. })) if *ratio > 1.0);
    expect(&mut harness, deeper);
    harness.event(Event::ModifiersChanged(Modifiers::NONE));
    harness.key_press(Key::Escape);
    harness.run();
    assert!(taken(&mut harness).contains(&TileEvent::Drag(DragEvent::Cancel)));
}

#[test]
fn a_limb_is_turned_by_its_body() {
    let scene = Scene::new();
    let framing = Framing::Free { zoom: 3.0, offset: [0.08, 0.0] };
    let mut harness = shown(
        TileInput { tile: TileView { framing, ..scene.posing().tile }, ..scene.posing() },
        WIDE,
        Theme::Dark,
    );
    let elbow = centre(&harness, "left elbow, Camera 1");
    let wrist = centre(&harness, "left wrist, Camera 1");
    let middle = elbow + (wrist - elbow) * 0.5;
    grab(&mut harness, middle, vec2(15.0, 0.0));
    let forearm = scene.body.limb_index("left forearm").unwrap();
    let turns = |event: &TileEvent| matches!(event, TileEvent::Drag(DragEvent::Begin(Drag::Turn { limb, .. })) if *limb == forearm);
    let events = expect(&mut harness, turns);
    assert!(events.contains(&TileEvent::SelectLimb(forearm)), "{events:?}");
}

#[test]
fn the_view_mode_is_chosen_from_the_header() {
    let scene = Scene::new();
    let mut harness = shown(scene.input(ViewMode::Tinted), [376.0, 456.0], Theme::Light);
    harness.get_by_label("Camera 1, view mode: Tinted overlay on footage").click();
    harness.run();
    Snapshots::default().picture(&harness.render().unwrap(), "camera_tile_mode_menu");
    harness.get_by_label_contains("Residual").click();
    harness.run();
    let expected = TileView { mode: ViewMode::Residual, ..TileView::default() };
    assert!(taken(&mut harness).contains(&TileEvent::SetView(expected)));
}

#[test]
fn header_and_gutter_say_what_was_clicked() {
    let scene = Scene::new();
    let mut harness = shown(scene.input(ViewMode::Tinted), WIDE, Theme::Dark);
    for (label, expected) in [
        ("Unlink zoom of Camera 1", TileEvent::SetLinked(false)),
        ("Expand Camera 1", TileEvent::ToggleExpanded),
        ("Used in the fit", TileEvent::SetUsed(false)),
    ] {
        harness.get_by_label(label).click();
        harness.run();
        let events = taken(&mut harness);
        assert!(events.contains(&expected), "{label}: {events:?}");
    }
    harness.get_by_label("IoU 0.777");
    let slider = harness.get_by_role_and_label(Role::Slider, "Weight of Camera 1").rect();
    harness.drag_at(slider.right_center() - vec2(7.0, 0.0));
    let_go(&mut harness, slider.right_center() - vec2(7.0, 0.0));
    let events = taken(&mut harness);
    assert!(matches!(events[..], [.., TileEvent::SetWeight(weight, _)] if weight > 1.8), "{events:?}");
    harness.get_by_label("More for Camera 1").click();
    harness.run();
    harness.get_by_label_contains("Whole picture").click();
    harness.run();
    assert!(taken(&mut harness).contains(&TileEvent::SetFraming(Framing::Whole)));
}

#[test]
fn the_wheel_zooms_and_the_right_button_pans() {
    let scene = Scene::new();
    let mut harness = shown(scene.posing(), WIDE, Theme::Dark);
    let at = centre(&harness, "Camera 1 picture");
    hover(&mut harness, at);
    harness.event(wheel(vec2(0.0, 60.0)));
    harness.run_steps(4);
    let zoomed =
        |event: &TileEvent| matches!(event, TileEvent::SetFraming(Framing::Free { zoom, .. }) if *zoom > 1.0);
    expect(&mut harness, zoomed);
    harness.event(button(at, PointerButton::Secondary, true));
    harness.run();
    hover(&mut harness, at + vec2(12.0, 0.0));
    harness.event(button(at + vec2(12.0, 0.0), PointerButton::Secondary, false));
    harness.run();
    let panned = |event: &TileEvent| matches!(event, TileEvent::SetFraming(Framing::Free { offset, .. }) if offset[0] < 0.0);
    let is_press =
        |event: &TileEvent| matches!(event, TileEvent::Drag(DragEvent::Begin(_)) | TileEvent::Activate);
    assert!(!expect(&mut harness, panned).iter().any(is_press));
}

#[test]
fn a_missing_silhouette_is_told_and_the_wipe_moved() {
    let scene = Scene::new();
    let picture = PictureInput { mask: None, data: None, ..scene.input(ViewMode::Data).picture };
    let tile = wipe(ViewMode::Footage, ViewMode::Prediction, 0.5);
    let input = TileInput { picture, overlap: None, tile, ..scene.input(ViewMode::Footage) };
    let mut harness = shown(input, WIDE, Theme::Dark);
    harness.get_by_label_contains("Drop a mask of this frame");
    let handle = centre(&harness, "Wipe to prediction");
    grab(&mut harness, handle, vec2(30.0, 0.0));
    let moved = |event: &TileEvent| matches!(event, TileEvent::SetView(view) if view.wipe_at > 0.6);
    let events = expect(&mut harness, moved);
    assert!(!events.contains(&TileEvent::Activate), "the picture under the handle is left alone");
}
