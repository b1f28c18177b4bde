//! Writes a figure, a heat map and a sheet to a folder: `cargo run -p backlit-plot --example plots -- FOLDER`.

use std::path::PathBuf;

use backlit_plot::{AsPicture, Axis, Figure, HeatMap, Line, Sheet, Theme, png};
use image::{GrayImage, Luma};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| ".".to_owned()));
    let falling = |rate: f64| (0..12).map(|step| 100.0 * (-rate * f64::from(step)).exp()).collect::<Vec<_>>();
    let figure = Figure {
        title: "Cost".to_owned(),
        subtitle: "Two fits of one frame, Σ w (D − Λ)²".to_owned(),
        x: Axis::linear("iteration"),
        y: Axis::log("cost, % of the start"),
        lines: vec![
            Line::of_values("Report 2004", 0, &falling(0.4)),
            Line::of_values("Robust", 1, &falling(0.9)).with_bars(vec![[2.0, 5.0, 40.0], [4.0, 1.0, 9.0]]),
        ],
    };
    let errors = |scale: f64| (0..121).map(|cell| Some(scale * f64::from(cell % 11))).collect();
    let map = HeatMap {
        title: "Basin".to_owned(),
        subtitle: "Distance at the end, by offset of the start".to_owned(),
        labels: ["left shoulder".to_owned(), "left elbow".to_owned()],
        ends_degrees: 60.0,
        columns: 11,
        maps: vec![("Report 2004".to_owned(), errors(22.0)), ("Robust".to_owned(), errors(9.0))],
        limit: 20.0,
    };
    let grey = |level| GrayImage::from_pixel(36, 48, Luma([level]));
    let sheet = Sheet {
        title: "D and Λ".to_owned(),
        subtitle: "36 × 48 pixels".to_owned(),
        columns: ["frame 1", "frame 9"].map(str::to_owned).into(),
        rows: vec![
            ("cam01 D".to_owned(), vec![grey(10), grey(20)]),
            ("cam01 Λ".to_owned(), vec![grey(30), grey(40)]),
        ],
    };
    for (name, plot) in [("figure", &figure as &dyn AsPicture), ("heat_map", &map), ("sheet", &sheet)] {
        for theme in Theme::ALL {
            let path = folder.join(format!("{name}_{theme:?}.png").to_lowercase());
            std::fs::write(path, png(plot.picture(theme))?)?;
        }
    }
    Ok(())
}
