//! What a frame of the window costs the processor, and how soon a drag shows: the real app without a display.
//!
//! `BACKLIT_DATA=… cargo bench -p backlit --bench frame_time [-- TAKE]`
//!
//! Without a take four views of the real footage (272 × 480); without `BACKLIT_DATA` the built-in take. 1600 × 1000
//! points. A frame's own work is everything from input to triangles: panels, edits, requests to the worker, layout, tessellation; it is the
//! processor's time of the window's thread. The worker has threads of its own, as in the window: how long a frame takes
//! by the clock, while they share the machine, stands beside that.

#![expect(clippy::unwrap_used, reason = "a measurement without its input is none")]

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use backlit::app::settings::Settings;
use backlit::app::{App, AppOptions, Opening};
use backlit::context::preferences::Layout;
use backlit::features::scene::{Upright, Viewpoint};
use backlit_take::source::TakeSource;
use egui::{Event, Key, Modifiers, PointerButton, Pos2, RawInput, Rect, pos2, vec2};

/// The program's.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

/// Points of the window.
const SIZE: egui::Vec2 = vec2(1600.0, 1000.0);
/// Sixty frames a second.
const FRAME: f64 = 1.0 / 60.0;
/// Frames of a measurement.
const FRAMES: usize = 300;
/// Nothing takes longer.
const PATIENCE: Duration = Duration::from_secs(60);

fn main() {
    let data = std::env::var_os("BACKLIT_DATA").map(PathBuf::from);
    let take = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/takes/balancing");
    let given = std::env::args_os().skip(1).find(|argument| argument != "--bench");
    let source = match (given, data.filter(|data| data.join("balancing").is_dir())) {
        (Some(given), _) => TakeSource::Path(given.into()),
        (None, Some(_)) => TakeSource::Path(take),
        (None, None) => TakeSource::BuiltIn,
    };
    println!("\n{source:?}, {} × {} points, {FRAMES} frames each", SIZE.x, SIZE.y);
    println!("{:<46} {:<29} by the clock", "", "own work");
    println!("{:<44} {:>9} {:>9} {:>9} {:>9} {:>9}", "", "median ms", "95 %", "max", "95 %", "max");
    for (name, layout) in [("pose layout", Layout::Pose), ("debug layout", Layout::Debug)] {
        let mut window = Window::open(&source, layout);
        window.measure(&format!("{name}: nothing happens"), |_, _| Vec::new());
        window.measure(&format!("{name}: pointer over a view"), |_, frame| {
            vec![Event::PointerMoved(pos2(200.0 + (frame % 100) as f32, 220.0))]
        });
        window.key(Key::Enter);
        window.settle();
        window.measure(&format!("{name}: a run is there"), |_, _| Vec::new());
        window.drag(name);
        if layout == Layout::Debug {
            window.turn_scene(name);
        }
        window.steps(name);
        window.measure(&format!("{name}: playing frames"), |window, frame| {
            if frame == 0 { window.events_of(Key::P) } else { Vec::new() }
        });
    }
}

/// A window without a display.
struct Window {
    context: egui::Context,
    app: App,
    frames: u64,
}

impl Window {
    fn open(source: &TakeSource, layout: Layout) -> Self {
        let context = egui::Context::default();
        let look = Settings { layout, ..Settings::default() };
        let opening = Some(Opening::Take(source.clone()));
        let began = Instant::now();
        let app = App::new(context.clone(), AppOptions { settings: look, opening, ..AppOptions::default() })
            .unwrap();
        let mut window = Self { context, app, frames: 0 };
        window.frame(Vec::new());
        let first = 1e3 * began.elapsed().as_secs_f64();
        window.settle();
        let settled = 1e3 * began.elapsed().as_secs_f64();
        println!("{layout:?}: first frame after {first:.0} ms, all views drawn after {settled:.0} ms");
        window
    }

    /// One frame; how long it took.
    fn frame(&mut self, events: Vec<Event>) -> Spent {
        let input = self.input(events);
        let (began, own_began) = (Instant::now(), own_seconds());
        let mut output = self.context.run_ui(input, |ui| self.app.frame(ui));
        // The pictures would go to the graphics card; building the program in a development profile asks that this is said.
        output.textures_delta.clear();
        let primitives = self.context.tessellate(output.shapes, output.pixels_per_point);
        let spent = Spent { own: own_seconds() - own_began, clock: began.elapsed().as_secs_f64() };
        drop(std::hint::black_box(primitives));
        spent
    }

    fn input(&mut self, events: Vec<Event>) -> RawInput {
        self.frames += 1;
        RawInput {
            screen_rect: Some(Rect::from_min_size(Pos2::ZERO, SIZE)),
            time: Some(self.frames as f64 * FRAME),
            predicted_dt: FRAME as f32,
            focused: true,
            events,
            ..RawInput::default()
        }
    }

    /// Runs frames until the worker has nothing to do.
    fn settle(&mut self) {
        let began = Instant::now();
        for _ in 0..4 {
            self.frame(Vec::new());
        }
        while !self.app.inspector.is_idle() {
            assert!(began.elapsed() < PATIENCE, "the worker hangs");
            std::thread::sleep(Duration::from_millis(2));
            self.frame(Vec::new());
        }
        self.frame(Vec::new());
    }

    fn events_of(&self, key: Key) -> Vec<Event> {
        let event = |pressed| Event::Key {
            key,
            physical_key: None,
            pressed,
            repeat: false,
            modifiers: Modifiers::NONE,
        };
        vec![event(true), event(false)]
    }

    fn key(&mut self, key: Key) {
        let events = self.events_of(key);
        self.frame(events);
    }

    /// Frames at the display's pace, so that the worker has the time that it has in life.
    fn measure(&mut self, name: &str, mut events: impl FnMut(&mut Self, usize) -> Vec<Event>) {
        let mut times = Vec::with_capacity(FRAMES);
        for index in 0..FRAMES {
            let events = events(self, index);
            let spent = self.frame(events);
            times.push(spent);
            std::thread::sleep(Duration::from_secs_f64((FRAME - spent.clock).max(0.0)));
        }
        print_row(name, &times);
        self.key(Key::Escape);
        self.settle();
    }

    /// A joint in the hand, moved in every frame; and how long until the views show what the pose predicts.
    fn drag(&mut self, layout: &str) {
        let from = self.place_of("right wrist");
        self.frame(vec![Event::PointerMoved(from)]);
        self.frame(vec![button(true, from)]);
        let (mut behind, mut drawing) = (Vec::new(), Vec::new());
        let (mut moving, mut showing) = (Vec::new(), Vec::new());
        let mut moved = Vec::new();
        for index in 0..FRAMES {
            let angle = index as f32 * 0.05;
            let to = from + 14.0 * vec2(angle.sin(), 1.0 - angle.cos());
            let before = self.app.inspector.document().pose_at(0).clone();
            let began = Instant::now();
            moving.push(self.frame(vec![Event::PointerMoved(to)]));
            moved.push(*self.app.inspector.document().pose_at(0) != before);
            // Frames of the display until the prediction is that of the pose.
            let mut frames = 0;
            while self.app.inspector.state.session.is_stale {
                std::thread::sleep(Duration::from_secs_f64(
                    (FRAME * f64::from(frames + 1) - began.elapsed().as_secs_f64()).max(0.0),
                ));
                showing.push(self.frame(Vec::new()));
                frames += 1;
                assert!(frames < 1000, "the prediction never comes");
            }
            behind.push(f64::from(frames));
            drawing.extend(self.app.inspector.state.session.predict_seconds.map(tenths_ms));
        }
        // The same without the display's pace.
        let mut waits = Vec::new();
        for index in 0..FRAMES / 3 {
            let angle = index as f32 * 0.05;
            let began = Instant::now();
            self.frame(vec![Event::PointerMoved(from + 14.0 * vec2(angle.sin(), angle.cos() - 1.0))]);
            while self.app.inspector.state.session.is_stale {
                std::thread::sleep(Duration::from_micros(500));
                self.frame(Vec::new());
            }
            waits.push(tenths_ms(began.elapsed().as_secs_f64()));
        }
        self.frame(vec![button(false, from)]);
        self.settle();
        print_row(&format!("{layout}: dragging, the pointer moves"), &moving);
        print_row(&format!("{layout}: dragging, silhouettes follow"), &showing);
        let dragged = moved.iter().filter(|moved| **moved).count();
        assert!(dragged > FRAMES / 2, "the hand holds nothing: the pose moved in {dragged} frames");
        print_behind("  pose drawn in that frame, silhouettes after", &mut behind, "frames");
        print_behind("  the worker draws them in", &mut drawing, "ms");
        print_behind("  without the display's pace, after", &mut waits, "ms");
    }

    /// The scene turned in every frame; and how far its picture is behind.
    fn turn_scene(&mut self, layout: &str) {
        let from = self.place_of("Scene");
        self.frame(vec![Event::PointerMoved(from)]);
        self.frame(vec![button(true, from)]);
        let (mut times, mut behind, mut eyes) = (Vec::new(), Vec::new(), Vec::new());
        for index in 0..FRAMES {
            let angle = index as f32 * 0.05;
            let to = from + 60.0 * vec2(angle.sin(), 1.0 - angle.cos());
            let spent = self.frame(vec![Event::PointerMoved(to)]);
            times.push(spent);
            let session = &self.app.inspector.state.session;
            let upright = Upright::of(&session.take.as_ref().unwrap().cameras);
            if let Some(Viewpoint::Orbit(orbit)) = self.app.inspector.settings().scene.viewpoint {
                eyes.push(orbit.camera(&upright).position);
            }
            let drawn = self.app.inspector.features.scene.drawing.as_ref().unwrap().order.eye.position;
            if let Some(turned) = eyes.iter().rposition(|eye| *eye == drawn) {
                behind.push((eyes.len() - 1 - turned) as f64);
            }
            std::thread::sleep(Duration::from_secs_f64((FRAME - spent.clock).max(0.0)));
        }
        self.frame(vec![button(false, from)]);
        self.settle();
        print_row(&format!("{layout}: turning the scene"), &times);
        assert!(behind.len() > FRAMES / 2, "the scene was drawn {} times", behind.len());
        print_behind("  picture of the scene", &mut behind, "frames");
    }

    /// Space in every frame: steps are made beside the frames.
    fn steps(&mut self, layout: &str) {
        self.measure(&format!("{layout}: stepping"), |window, frame| {
            if frame % 2 == 0 { window.events_of(Key::Space) } else { Vec::new() }
        });
    }

    /// Where the first widget is whose name begins so.
    fn place_of(&mut self, name: &str) -> Pos2 {
        self.context.enable_accesskit();
        let input = self.input(Vec::new());
        let mut output = self.context.run_ui(input, |ui| self.app.frame(ui));
        output.textures_delta.clear();
        self.context.disable_accesskit();
        let update = output.platform_output.accesskit_update.unwrap();
        let found = update.nodes.iter().find_map(|(_, node)| {
            let is_it =
                node.label().is_some_and(|label| label == name || label.starts_with(&format!("{name},")));
            node.bounds().filter(|_| is_it)
        });
        let bounds = found.unwrap_or_else(|| {
            let names: Vec<_> = update.nodes.iter().filter_map(|(_, node)| node.label()).collect();
            panic!("no {name} among {names:?}")
        });
        pos2((0.5 * (bounds.x0 + bounds.x1)) as f32, (0.5 * (bounds.y0 + bounds.y1)) as f32)
    }
}

/// What a frame took, in seconds.
#[derive(Clone, Copy)]
struct Spent {
    /// Of the processor, on the window's thread.
    own: f64,
    /// By the clock.
    clock: f64,
}

/// The processor's time of this thread.
#[cfg(unix)]
fn own_seconds() -> f64 {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}

/// The clock, where nothing tells the processor's time.
#[cfg(not(unix))]
fn own_seconds() -> f64 {
    static BEGAN: std::sync::LazyLock<Instant> = std::sync::LazyLock::new(Instant::now);
    BEGAN.elapsed().as_secs_f64()
}

fn button(pressed: bool, pos: Pos2) -> Event {
    Event::PointerButton { pos, button: PointerButton::Primary, pressed, modifiers: Modifiers::NONE }
}

fn print_row(name: &str, times: &[Spent]) {
    let sorted = |of: fn(&Spent) -> f64| {
        let mut sorted: Vec<f64> = times.iter().map(of).collect();
        sorted.sort_by(f64::total_cmp);
        move |share: f64| 1e3 * sorted[((sorted.len() - 1) as f64 * share) as usize]
    };
    let (own, clock) = (sorted(|spent| spent.own), sorted(|spent| spent.clock));
    let [median, most, max] = [0.5, 0.95, 1.0].map(own);
    println!("{name:<44} {median:>9.2} {most:>9.2} {max:>9.2} {:>9.2} {:>9.2}", clock(0.95), clock(1.0));
}

fn tenths_ms(seconds: f64) -> f64 {
    (1e4 * seconds).round() / 10.0
}

fn print_behind(name: &str, waits: &mut [f64], unit: &str) {
    waits.sort_by(f64::total_cmp);
    let at = |share: f64| waits[((waits.len() - 1) as f64 * share) as usize];
    println!("{name:<44} median {}, 95 % {}, max {} {unit}", at(0.5), at(0.95), at(1.0));
}
