//! The pointer's way from a press to events: three points of travel start a drag, modifiers say which, Esc puts
//! back. A modifier pressed or let go on the way goes on otherwise from where the pointer is.

use std::f64::consts::{PI, TAU};

use backlit_tracking::body::Model;
use backlit_ui::drawing::{Drag, DragEvent, JointId, JointMark, ProjectedLimb, draggable_joints};
use backlit_ui::widgets::{Grip, ViewTransform};
use egui::{Modifiers, Pos2};
use glam::DVec2;

use super::TileEvent;

/// Travel that makes a press a drag, in points.
const TRAVEL: f32 = 3.0;

/// So far from where something was dropped the pointer has left the place, in points.
const LEAVES: f32 = 24.0;

/// Upward travel that multiplies a depth by e, in points.
const DEPTH_POINTS: f64 = 500.0;

/// Twist for each point of travel to the right, in radians: half a degree.
const TWIST_PER_POINT: f64 = PI / 360.0;

/// The pointer in this frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PointerInput {
    pub(crate) at: Pos2,
    /// Where the button went down on the picture in this frame. In a slow frame the pointer has left the place since.
    pub(crate) pressed_at: Option<Pos2>,
    /// The button that went down on the picture is still down.
    pub(crate) is_down: bool,
    /// Modifier keys that are down.
    pub(crate) modifiers: Modifiers,
    /// Esc was pressed.
    pub(crate) is_cancelled: bool,
}

/// What can be taken hold of.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Grips<'a> {
    pub(crate) body: &'a Model,
    pub(crate) joints: &'a [JointMark],
    pub(crate) limbs: &'a [Option<ProjectedLimb>],
    pub(crate) view: ViewTransform,
}

/// What a drag does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Action {
    Joint(JointId),
    Depth(JointId),
    Twist(usize),
    Turn(usize),
    Body,
    Length(usize),
    Radius(usize),
}

/// The pointer's state in one tile.
#[derive(Clone, Debug, Default)]
pub(crate) struct Pointer {
    press: Option<Press>,
    /// What is under the pointer while nothing is held.
    pub(crate) hovered: Option<Grip>,
    /// Where something was dropped, until the pointer leaves the place.
    dropped_at: Option<Pos2>,
}

#[derive(Clone, Copy, Debug)]
struct Press {
    grip: Grip,
    pressed_at: Pos2,
    phase: PressPhase,
}

#[derive(Clone, Copy, Debug)]
enum PressPhase {
    Pressed,
    Dragging(Anchor),
    Cancelled,
}

/// Where a drag started.
#[derive(Clone, Copy, Debug)]
struct Anchor {
    action: Action,
    origin: Pos2,
    origin_px: DVec2,
    last: Pos2,
    joint_px: DVec2,
    depth_m: f64,
    pivot_px: DVec2,
    /// Angle swept so far, over more than a whole turn.
    swept_rad: f64,
}

impl Pointer {
    /// What is pressed or dragged.
    pub(crate) fn grip(&self) -> Option<Grip> {
        self.press.filter(|press| !matches!(press.phase, PressPhase::Cancelled)).map(|press| press.grip)
    }

    /// Whether something was just dropped here: nothing is to cover it.
    pub(crate) fn has_dropped(&self) -> bool {
        self.dropped_at.is_some()
    }

    /// Whether a press has taken hold of nothing.
    pub(crate) fn is_free(&self) -> bool {
        self.press.is_none()
    }

    /// What the drag in progress does.
    pub(crate) fn action(&self) -> Option<Action> {
        match self.press?.phase {
            PressPhase::Dragging(anchor) => Some(anchor.action),
            PressPhase::Pressed | PressPhase::Cancelled => None,
        }
    }

    /// Takes in one frame of the pointer; `under` is what it is on, or what it was pressed on in this frame.
    pub(crate) fn update(
        &mut self,
        pointer: &PointerInput,
        under: Option<Grip>,
        grips: &Grips<'_>,
        events: &mut Vec<TileEvent>,
    ) {
        self.dropped_at = self.dropped_at.filter(|place| pointer.at.distance(*place) < LEAVES);
        if let Some(pressed_at) = pointer.pressed_at {
            self.press = under.map(|grip| Press { grip, pressed_at, phase: PressPhase::Pressed });
            events.push(TileEvent::Activate);
            events.extend(under.map(|grip| match grip {
                Grip::Joint(joint) => TileEvent::SelectJoint(joint),
                Grip::Limb(limb) | Grip::Length(limb) | Grip::Radius(limb) => TileEvent::SelectLimb(limb),
            }));
        }
        self.hovered = under.filter(|_| self.press.is_none());
        let Some(press) = &mut self.press else { return };
        match press.phase {
            PressPhase::Pressed if pointer.is_cancelled => press.phase = PressPhase::Cancelled,
            PressPhase::Pressed if pointer.at.distance(press.pressed_at) >= TRAVEL => {
                let action = action(press.grip, pointer.modifiers, grips.body);
                let mut anchor = Anchor::new(action, press.grip, press.pressed_at, grips);
                events.push(TileEvent::Drag(DragEvent::Begin(anchor.drag(pointer.at, grips))));
                press.phase = PressPhase::Dragging(anchor);
            }
            PressPhase::Dragging(_) if pointer.is_cancelled => {
                events.push(TileEvent::Drag(DragEvent::Cancel));
                press.phase = PressPhase::Cancelled;
            }
            PressPhase::Dragging(mut anchor) => {
                let action = action(press.grip, pointer.modifiers, grips.body);
                if pointer.is_down && action != anchor.action {
                    anchor = Anchor::new(action, press.grip, pointer.at, grips);
                    events.push(TileEvent::Drag(DragEvent::Begin(anchor.drag(pointer.at, grips))));
                } else if pointer.at != anchor.last {
                    events.push(TileEvent::Drag(DragEvent::Move(anchor.drag(pointer.at, grips))));
                }
                press.phase = PressPhase::Dragging(anchor);
            }
            PressPhase::Pressed | PressPhase::Cancelled => {}
        }
        if !pointer.is_down {
            if matches!(press.phase, PressPhase::Dragging(_)) {
                events.push(TileEvent::Drag(DragEvent::End));
                self.dropped_at = Some(pointer.at);
            }
            self.press = None;
        }
    }
}

impl Anchor {
    fn new(action: Action, grip: Grip, origin: Pos2, grips: &Grips<'_>) -> Self {
        let origin_px = grips.view.px_from_screen(origin);
        let joint = match (action, grip) {
            (Action::Joint(joint) | Action::Depth(joint), _) | (_, Grip::Joint(joint)) => Some(joint),
            (_, Grip::Limb(_) | Grip::Length(_) | Grip::Radius(_)) => None,
        };
        let mark = grips.joints.iter().find(|mark| Some(mark.id) == joint);
        let limb = |index: usize| grips.limbs.get(index).copied().flatten();
        let held_limb = match grip {
            Grip::Limb(index) | Grip::Length(index) | Grip::Radius(index) => limb(index),
            Grip::Joint(_) => None,
        };
        // What moves with the pointer: the limb's end, or its outline on the side that was taken hold of.
        let sized_px = held_limb.and_then(|limb| match action {
            Action::Length(_) => Some(limb.ends_px[1]),
            Action::Radius(_) => {
                let sides = [-1.0, 1.0].map(|side| limb.side_px(side));
                sides.into_iter().min_by(|a, b| a.distance(origin_px).total_cmp(&b.distance(origin_px)))
            }
            _ => None,
        });
        let pivot = match action {
            Action::Turn(owner) => limb(owner).or(held_limb).map(|limb| limb.ends_px[0]),
            _ => None,
        };
        let depth_m = mark.map(|mark| mark.depth_m).or(held_limb.map(|limb| limb.depth_at(origin_px)));
        Self {
            action,
            origin,
            origin_px,
            last: origin,
            joint_px: sized_px.or(mark.map(|mark| mark.px)).unwrap_or(origin_px),
            depth_m: depth_m.unwrap_or(1.0),
            pivot_px: pivot.unwrap_or(origin_px),
            swept_rad: 0.0,
        }
    }

    /// The drag with the pointer at `at`.
    fn drag(&mut self, at: Pos2, grips: &Grips<'_>) -> Drag {
        let px = grips.view.px_from_screen(at);
        let travel = at - self.origin;
        let previous = std::mem::replace(&mut self.last, at);
        match self.action {
            Action::Joint(joint) => Drag::Joint { joint, target_px: self.joint_px + px - self.origin_px },
            Action::Depth(joint) => Drag::Depth { joint, ratio: (-f64::from(travel.y) / DEPTH_POINTS).exp() },
            Action::Twist(limb) => Drag::Twist { limb, angle_rad: f64::from(travel.x) * TWIST_PER_POINT },
            Action::Turn(limb) => {
                let angle = |px: DVec2| (px - self.pivot_px).to_angle();
                let change = angle(px) - angle(grips.view.px_from_screen(previous));
                self.swept_rad += (change + PI).rem_euclid(TAU) - PI;
                Drag::Turn { limb, pivot_px: self.pivot_px, angle_rad: self.swept_rad }
            }
            Action::Length(limb) => {
                Drag::Length { limb, from_px: self.joint_px, to_px: self.joint_px + px - self.origin_px }
            }
            Action::Radius(limb) => {
                Drag::Radius { limb, from_px: self.joint_px, to_px: self.joint_px + px - self.origin_px }
            }
            Action::Body => Drag::Body { from_px: self.origin_px, to_px: px, depth_m: self.depth_m },
        }
    }
}

/// What a drag of `grip` with these modifiers does.
fn action(grip: Grip, modifiers: Modifiers, body: &Model) -> Action {
    let (shift, ctrl) = (modifiers.shift, modifiers.ctrl || modifiers.command);
    match (grip, shift, ctrl) {
        (Grip::Length(limb), ..) => Action::Length(limb),
        (Grip::Radius(limb), ..) => Action::Radius(limb),
        (Grip::Joint(JointId::Root), true, false) => Action::Depth(JointId::Root),
        (Grip::Joint(JointId::Root), ..) | (_, true, true) => Action::Body,
        (Grip::Joint(joint), true, false) => Action::Depth(joint),
        (Grip::Limb(limb), true, false) => Action::Depth(JointId::End(limb_with_handle(body, limb))),
        (Grip::Joint(JointId::End(limb)) | Grip::Limb(limb), false, true) => {
            Action::Twist(rotation_owner(body, limb))
        }
        (Grip::Joint(joint), false, false) => Action::Joint(joint),
        (Grip::Limb(limb), false, false) => Action::Turn(rotation_owner(body, limb)),
    }
}

/// The limb whose rotation this one follows.
pub(crate) fn rotation_owner(body: &Model, limb: usize) -> usize {
    let rotation = body.limbs().get(limb).map(|limb| limb.rotation);
    rotation.and_then(|rotation| body.rotation_owners().get(rotation).copied()).unwrap_or(limb)
}

/// Of the limbs that turn with this one, itself if it has a handle at its end, else the first that has.
fn limb_with_handle(body: &Model, limb: usize) -> usize {
    let owner = rotation_owner(body, limb);
    let handles = draggable_joints(body);
    let has_handle = |limb: usize| handles.contains(&JointId::End(limb));
    if has_handle(limb) {
        return limb;
    }
    (0..body.limbs().len())
        .find(|&other| rotation_owner(body, other) == owner && has_handle(other))
        .unwrap_or(owner)
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::builtin::full_body;
    use backlit_tracking::render::RendererKind;
    use egui::{Rect, pos2, vec2};

    use super::*;

    /// A view of 2 points a pixel, a wrist at pixel (50, 50), and the right forearm from (10, 50) to there.
    struct Fixture {
        body: Model,
        joints: Vec<JointMark>,
        limbs: Vec<Option<ProjectedLimb>>,
        pointer: Pointer,
        forearm: usize,
    }

    const RECT: Rect = Rect { min: Pos2::ZERO, max: pos2(200.0, 200.0) };
    const WRIST: Pos2 = pos2(100.0, 100.0);

    impl Fixture {
        fn new() -> Self {
            let body = full_body();
            let forearm = body.limb_index("right forearm").unwrap();
            let mark = |id, x: f64| JointMark {
                id,
                name: String::new(),
                px: DVec2::new(x, 50.0),
                depth_m: 2.0,
                is_pinned: false,
            };
            let joints = vec![mark(JointId::End(forearm), 50.0), mark(JointId::Root, 90.0)];
            let mut limbs = vec![None; body.limbs().len()];
            limbs[forearm] = Some(ProjectedLimb {
                ends_px: [DVec2::new(10.0, 50.0), DVec2::new(50.0, 50.0)],
                radii_px: [4.0; 2],
                depths_m: [3.0; 2],
                solid: RendererKind::Capsule,
            });
            Self { body, joints, limbs, pointer: Pointer::default(), forearm }
        }

        fn frame(&mut self, at: Pos2, button: &str, modifiers: Modifiers) -> Vec<TileEvent> {
            self.moved((button == "press").then_some(at), at, button, modifiers)
        }

        fn moved(&mut self, press: Option<Pos2>, at: Pos2, button: &str, keys: Modifiers) -> Vec<TileEvent> {
            let view = ViewTransform { rect: RECT, points_per_px: 2.0, centre_px: pos2(50.0, 50.0) };
            let grips = Grips { body: &self.body, joints: &self.joints, limbs: &self.limbs, view };
            let place = press.unwrap_or(at);
            let under = backlit_ui::widgets::grip_at(place, &view, &self.joints, &self.limbs);
            let pointer = PointerInput {
                at,
                pressed_at: press,
                is_down: button != "up",
                modifiers: keys,
                is_cancelled: button == "escape",
            };
            let mut events = Vec::new();
            self.pointer.update(&pointer, under, &grips, &mut events);
            events
        }
    }

    fn begin(drag: Drag) -> TileEvent {
        TileEvent::Drag(DragEvent::Begin(drag))
    }

    #[test]
    fn three_points_of_travel_start_a_drag_that_keeps_the_grip() {
        let mut fixture = Fixture::new();
        let joint = JointId::End(fixture.forearm);
        let grabbed = WRIST + vec2(4.0, 0.0);
        let events = fixture.frame(grabbed, "press", Modifiers::NONE);
        assert_eq!(events, [TileEvent::Activate, TileEvent::SelectJoint(joint)]);
        assert_eq!(fixture.pointer.grip(), Some(Grip::Joint(joint)));
        assert!(fixture.frame(grabbed + vec2(2.9, 0.0), "down", Modifiers::NONE).is_empty());
        let drag = |x: f64| Drag::Joint { joint, target_px: DVec2::new(x, 50.0) };
        let events = fixture.frame(grabbed + vec2(3.0, 0.0), "down", Modifiers::NONE);
        assert_eq!(events, [begin(drag(51.5))]);
        let far = grabbed + vec2(600.0, 0.0);
        assert_eq!(
            fixture.frame(far, "down", Modifiers::NONE),
            [TileEvent::Drag(DragEvent::Move(drag(350.0)))]
        );
        assert!(fixture.frame(far, "down", Modifiers::NONE).is_empty(), "nothing new while it rests");
        assert_eq!(fixture.frame(far, "up", Modifiers::NONE), [TileEvent::Drag(DragEvent::End)]);
        assert!(fixture.frame(far, "up", Modifiers::NONE).is_empty());
    }

    #[test]
    fn a_press_holds_what_it_was_on_though_the_pointer_has_left_within_the_frame() {
        let mut fixture = Fixture::new();
        let joint = JointId::End(fixture.forearm);
        let events = fixture.moved(Some(WRIST), WRIST + vec2(0.0, 60.0), "down", Modifiers::NONE);
        let drag = begin(Drag::Joint { joint, target_px: DVec2::new(50.0, 80.0) });
        assert_eq!(events, [TileEvent::Activate, TileEvent::SelectJoint(joint), drag]);
    }

    #[test]
    fn a_click_selects_and_drags_nothing() {
        let mut fixture = Fixture::new();
        fixture.frame(WRIST, "press", Modifiers::NONE);
        assert!(fixture.frame(WRIST + vec2(1.0, 1.0), "up", Modifiers::NONE).is_empty());
    }

    #[test]
    fn escape_puts_back_until_the_next_press() {
        let mut fixture = Fixture::new();
        fixture.frame(WRIST, "press", Modifiers::NONE);
        fixture.frame(WRIST + vec2(9.0, 0.0), "down", Modifiers::NONE);
        let events = fixture.frame(WRIST + vec2(9.0, 0.0), "escape", Modifiers::NONE);
        assert_eq!(events, [TileEvent::Drag(DragEvent::Cancel)]);
        assert!(fixture.frame(WRIST + vec2(40.0, 0.0), "down", Modifiers::NONE).is_empty());
        assert!(fixture.frame(WRIST, "up", Modifiers::NONE).is_empty());
    }

    #[test]
    fn a_limb_turns_about_its_first_joint_over_more_than_half_a_turn() {
        let mut fixture = Fixture::new();
        let at = |degrees: f32| pos2(20.0, 100.0) + 50.0 * egui::Vec2::angled(degrees.to_radians());
        fixture.frame(at(0.0), "press", Modifiers::NONE);
        let mut last = None;
        for step in 1..=27 {
            last = fixture.frame(at(10.0 * step as f32), "down", Modifiers::NONE).pop();
        }
        let Some(TileEvent::Drag(DragEvent::Move(Drag::Turn { limb, pivot_px, angle_rad }))) = last else {
            panic!("{last:?}")
        };
        assert_eq!((limb, pivot_px), (fixture.forearm, DVec2::new(10.0, 50.0)));
        assert!((angle_rad.to_degrees() - 270.0).abs() < 0.1, "{}", angle_rad.to_degrees());
    }

    #[test]
    fn modifiers_choose_the_action_and_change_it_on_the_way() {
        let mut fixture = Fixture::new();
        let joint = JointId::End(fixture.forearm);
        let up = WRIST - vec2(0.0, 50.0);
        fixture.frame(WRIST, "press", Modifiers::SHIFT);
        let events = fixture.frame(up, "down", Modifiers::SHIFT);
        let [TileEvent::Drag(DragEvent::Begin(Drag::Depth { joint: moved, ratio }))] = events[..] else {
            panic!("{events:?}")
        };
        assert!(moved == joint && (ratio - 0.1_f64.exp()).abs() < 1e-6);
        let events = fixture.frame(up, "down", Modifiers::CTRL);
        let twist = Drag::Twist { limb: fixture.forearm, angle_rad: 0.0 };
        assert_eq!(events, [begin(twist)]);
        let events = fixture.frame(up + vec2(20.0, 0.0), "down", Modifiers::CTRL | Modifiers::SHIFT);
        let from_px = DVec2::new(60.0, 25.0);
        let body = Drag::Body { from_px, to_px: from_px, depth_m: 2.0 };
        assert_eq!(events, [begin(body)]);
    }

    #[test]
    fn the_root_takes_the_whole_body_and_limbs_without_handle_give_their_neighbour() {
        let body = full_body();
        assert_eq!(action(Grip::Joint(JointId::Root), Modifiers::NONE, &body), Action::Body);
        assert_eq!(action(Grip::Joint(JointId::Root), Modifiers::SHIFT, &body), Action::Depth(JointId::Root));
        let limb = |name: &str| body.limb_index(name).unwrap();
        let thigh = Grip::Limb(limb("right thigh"));
        let knee = JointId::End(limb("right lower thigh"));
        assert_eq!(action(thigh, Modifiers::SHIFT, &body), Action::Depth(knee));
        let lower = Grip::Limb(limb("right lower thigh"));
        assert_eq!(action(lower, Modifiers::NONE, &body), Action::Turn(limb("right thigh")));
        assert_eq!(limb_with_handle(&body, limb("right hand")), limb("right forearm"));
    }
}
