//! What a frame of a video costs, ms: `cargo run --release -p backlit-formats --example decode -- FILE [DIVISOR]`.

use std::path::Path;
use std::time::Instant;

use backlit_formats::video::Video;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let file = arguments.next().ok_or("which video?")?;
    let divisor = arguments.next().map_or(Ok(1), |text| text.parse())?;
    let opening = Instant::now();
    let video = Video::open(Path::new(&file))?;
    let opened = opening.elapsed().as_secs_f64() * 1e3;
    let [width, height] = video.size();
    println!(
        "{} frames of {width} × {height}, {}, opened in {opened:.1} ms",
        video.frame_count(),
        video.codec()
    );
    video.notes().iter().for_each(|note| println!("{note}"));
    let count = video.frame_count();
    // The first one waits for nothing but itself, so it is not counted.
    video.frame_reduced(0, divisor)?;
    times(&video, divisor, "in order, two ahead", (1..count).collect())?;
    let again = Video::open(Path::new(&file))?;
    again.frame_reduced(0, divisor)?;
    // Every second one: nothing is decoded ahead, and a frame costs two decodes.
    times(&again, divisor, "every second", (2..count).step_by(2).collect())?;
    let anywhere = Video::open(Path::new(&file))?;
    times(&anywhere, divisor, "anywhere", (0..20).map(|k| k * 37 % count).collect())?;
    times(&anywhere, divisor, "kept", (0..20).map(|k| k * 37 % count).collect())?;
    times(&Video::open(Path::new(&file))?, divisor, "a leap to the last", vec![count - 1])
}

fn times(
    video: &Video,
    divisor: usize,
    name: &str,
    frames: Vec<usize>,
) -> Result<(), Box<dyn std::error::Error>> {
    let before = video.decoded_count();
    let mut times = Vec::with_capacity(frames.len());
    let all = Instant::now();
    for &frame in &frames {
        let start = Instant::now();
        video.frame_reduced(frame, divisor)?;
        times.push(start.elapsed().as_secs_f64() * 1e3);
    }
    let mean = all.elapsed().as_secs_f64() * 1e3 / frames.len() as f64;
    times.sort_by(f64::total_cmp);
    let at = |part: usize| times[(times.len() - 1) * part / 100];
    let decoded = video.decoded_count() - before;
    println!(
        "{name}: median {:.1}, quartiles {:.1} to {:.1}, mean {mean:.1} ms; {decoded} decoded for {} frames",
        at(50),
        at(25),
        at(75),
        frames.len()
    );
    Ok(())
}
