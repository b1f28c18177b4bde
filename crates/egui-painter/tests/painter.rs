//! The rules that a picture follows, and pictures that must stay the same to the bit.

use std::sync::Arc;

use egui::epaint::{ClippedPrimitive, ImageDelta, Mesh, PaintCallback, Primitive, Vertex};
use egui::{
    Color32, ColorImage, Pos2, Rect, TextureId, TextureOptions, TextureWrapMode, TexturesDelta, Ui, pos2,
    vec2,
};
use egui_painter::{Headless, Painter, RgbaImage, Skipped};

const RED: Color32 = Color32::from_rgb(255, 0, 0);

fn painter(texture: ColorImage, options: TextureOptions) -> Painter {
    let mut delta = TexturesDelta::default();
    delta.push(TextureId::default(), ImageDelta::full(texture, options));
    let mut painter = Painter::default();
    painter.update(&mut delta);
    painter
}

fn paint(
    size: u32,
    background: Color32,
    texture: ColorImage,
    options: TextureOptions,
    mesh: Mesh,
) -> RgbaImage {
    let mut painter = painter(texture, options);
    let clip_rect = Rect::from_min_max(pos2(0.0, 0.0), pos2(100.0, 7.4));
    let primitives = [ClippedPrimitive { clip_rect, primitive: Primitive::Mesh(mesh) }];
    let image = painter.paint(&primitives, 1.0, [size; 2], background);
    assert_eq!(painter.skipped, Skipped::default());
    image
}

fn white() -> ColorImage {
    ColorImage::filled([1, 1], Color32::WHITE)
}

/// Corners without a texture, in colours by x, and triangles between them.
fn triangles(corners: &[(f32, f32)], colour: impl Fn(f32) -> Color32, triangles: &[[u32; 3]]) -> Mesh {
    let mut mesh = Mesh::default();
    for (x, y) in corners {
        mesh.vertices.push(Vertex::untextured(pos2(*x, *y), colour(*x)));
    }
    for [a, b, c] in triangles {
        mesh.add_triangle(*a, *b, *c);
    }
    mesh
}

/// The red channel in sixteenths, a hexadecimal digit a pixel.
fn digits(image: &RgbaImage) -> Vec<String> {
    let digit = |x, y| format!("{:x}", image.get_pixel(x, y).0[0] / 16);
    (0..image.height()).map(|y| (0..image.width()).map(|x| digit(x, y)).collect()).collect()
}

#[test]
fn a_triangle_is_filled_up_to_its_clip() {
    let mesh = triangles(&[(1.0, 1.0), (9.0, 1.0), (1.0, 9.0)], |_| RED, &[[0, 1, 2]]);
    let image = paint(10, Color32::BLACK, white(), TextureOptions::LINEAR, mesh);
    let expected = [
        "0000000000",
        "0fffffff00",
        "0ffffff000",
        "0fffff0000",
        "0ffff00000",
        "0fff000000",
        "0ff0000000",
        "0000000000",
        "0000000000",
        "0000000000",
    ];
    assert_eq!(digits(&image), expected);
}

#[test]
fn translucent_triangles_that_share_an_edge_leave_no_seam() {
    let half_red = Color32::from_rgba_premultiplied(128, 0, 0, 128);
    let corners = [(0.0, 0.0), (10.0, 0.3), (0.0, 10.0), (10.0, 10.0)];
    let mesh = triangles(&corners, |_| half_red, &[[0, 1, 2], [3, 2, 1]]);
    let image = paint(7, Color32::WHITE, white(), TextureOptions::LINEAR, mesh);
    for pixel in image.pixels() {
        assert_eq!(pixel.0, [255, 127, 127, 255]);
    }
}

#[test]
fn colours_run_evenly_between_corners() {
    let corners = [(0.0, 0.0), (8.0, 0.0), (0.0, 8.0), (8.0, 8.0)];
    let grey = |x: f32| Color32::from_gray((x / 8.0 * 240.0) as u8);
    let mesh = triangles(&corners, grey, &[[0, 1, 2], [2, 1, 3]]);
    let image = paint(8, Color32::BLACK, white(), TextureOptions::LINEAR, mesh);
    for row in &digits(&image)[..7] {
        assert_eq!(row, "02468ace");
    }
}

#[test]
fn textures_are_mixed_or_picked_as_they_ask() {
    let texture = ColorImage::new([2, 1], vec![Color32::BLACK, Color32::from_gray(240)]);
    let square = |top: f32| {
        let mut mesh = Mesh::default();
        let uv = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        let rect = Rect::from_min_size(pos2(0.0, 0.0), vec2(8.0, 8.0));
        mesh.add_rect_with_uv(rect, uv, Color32::WHITE);
        // A lifted corner takes the way through triangles instead of upright rectangles.
        mesh.vertices[1].pos.y += top;
        mesh
    };
    for lift in [0.0, 0.25] {
        let linear = paint(8, RED, texture.clone(), TextureOptions::LINEAR, square(lift));
        assert_eq!(digits(&linear)[3], "00159dff");
        let nearest = paint(8, RED, texture.clone(), TextureOptions::NEAREST, square(lift));
        assert_eq!(digits(&nearest)[3], "0000ffff");
    }
}

#[test]
fn colours_are_modulated_and_blended_as_they_are() {
    let half_white = Color32::from_rgba_premultiplied(128, 128, 128, 128);
    let mesh = triangles(&[(0.0, 0.0), (16.0, 0.0), (0.0, 16.0)], |_| half_white, &[[0, 1, 2]]);
    // Half of white over black is 128 in gamma space; in linear light it would be 188.
    let over_black = paint(4, Color32::BLACK, white(), TextureOptions::LINEAR, mesh.clone());
    assert!(over_black.pixels().all(|pixel| pixel.0 == [128, 128, 128, 255]));
    // A texel of 100 of 255, half as opaque: 128 · 100 / 255 = 50 of light, and 127/255 of the ground's 40.
    let grey = ColorImage::filled([1, 1], Color32::from_gray(100));
    let over_grey = paint(4, Color32::from_gray(40), grey, TextureOptions::LINEAR, mesh);
    assert!(over_grey.pixels().all(|pixel| pixel.0 == [70, 70, 70, 255]));
}

#[test]
fn textures_repeat_mirror_or_end_as_they_ask() {
    let texture = ColorImage::new([2, 1], vec![Color32::BLACK, Color32::from_gray(240)]);
    let rows = [
        (TextureWrapMode::ClampToEdge, "000fffff"),
        (TextureWrapMode::Repeat, "0f0f0f0f"),
        (TextureWrapMode::MirroredRepeat, "f00ff00f"),
    ];
    for (wrap_mode, expected) in rows {
        let mut mesh = Mesh::default();
        let uv = Rect::from_min_max(pos2(-1.0, 0.0), pos2(3.0, 1.0));
        mesh.add_rect_with_uv(Rect::from_min_size(Pos2::ZERO, vec2(8.0, 8.0)), uv, Color32::WHITE);
        let options = TextureOptions { wrap_mode, ..TextureOptions::NEAREST };
        assert_eq!(digits(&paint(8, RED, texture.clone(), options, mesh))[0], expected);
    }
}

#[test]
fn what_cannot_be_painted_is_left_out_and_counted() {
    let places = [(0.0, 0.0), (4.0, 0.0), (0.0, 4.0), (f32::NAN, 1.0), (1e30, f32::INFINITY), (2.0, 2.0)];
    let mut mesh = triangles(&places, |_| RED, &[]);
    mesh.vertices.push(Vertex { uv: pos2(f32::NAN, 0.0), ..mesh.vertices[0] });
    for [a, b, c] in [[0, 1, 3], [4, 1, 2], [0, 1, 99], [0, 6, 2]] {
        mesh.add_triangle(a, b, c);
    }
    // Without area, and with one index too many: neither is a mistake.
    mesh.add_triangle(1, 5, 2);
    mesh.indices.push(0);
    let lost = Mesh { texture_id: TextureId::User(5), ..mesh.clone() };
    let clip_rect = Rect::EVERYTHING;
    let callback = PaintCallback { rect: clip_rect, callback: Arc::new(()) };
    let primitives = [Primitive::Mesh(mesh), Primitive::Mesh(lost), Primitive::Callback(callback)]
        .map(|primitive| ClippedPrimitive { clip_rect, primitive });
    let mut painter = painter(white(), TextureOptions::LINEAR);
    let image = painter.paint(&primitives, 1.0, [4, 4], Color32::BLACK);
    assert_eq!(digits(&image).concat(), "0".repeat(16));
    assert_eq!(painter.skipped, Skipped { callbacks: 1, meshes: 1, triangles: 4, images: 0 });
}

#[test]
fn images_that_do_not_fit_are_refused_and_counted() {
    let mut painter = painter(ColorImage::filled([2, 2], RED), TextureOptions::NEAREST);
    let square = || {
        let mut mesh = Mesh::default();
        let rect = Rect::from_min_size(Pos2::ZERO, vec2(2.0, 2.0));
        mesh.add_rect_with_uv(rect, Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0)), Color32::WHITE);
        [ClippedPrimitive { clip_rect: rect, primitive: Primitive::Mesh(mesh) }]
    };
    let mut lying = white();
    lying.size = [usize::MAX, 2];
    for (id, image, pos) in [
        (TextureId::default(), lying, None),
        (TextureId::default(), ColorImage::default(), None),
        (TextureId::default(), white(), Some([usize::MAX, 0])),
        (TextureId::default(), ColorImage::filled([1, 2], Color32::WHITE), Some([0, 1])),
        (TextureId::User(7), white(), Some([0, 0])),
    ] {
        let mut delta = TexturesDelta::default();
        delta.push(id, ImageDelta { image: image.into(), options: TextureOptions::NEAREST, pos });
        let before = painter.skipped.images;
        painter.update(&mut delta);
        assert_eq!(painter.skipped.images, before + 1, "{id:?} at {pos:?}");
        assert!(painter.paint(&square(), 1.0, [2, 2], RED).pixels().all(|p| p.0 == [255, 0, 0, 255]));
    }
}

#[test]
fn odd_numbers_are_harmless() {
    let mut mesh = Mesh::default();
    for (x, y, u, v) in [(-1e30, -1e30, -1e30, 1e30), (1e30, 0.0, f32::MAX, 0.5), (0.0, 1e30, 0.0, -1e38)] {
        mesh.vertices.push(Vertex { pos: pos2(x, y), uv: pos2(u, v), color: RED });
    }
    mesh.add_triangle(0, 1, 2);
    let rect = Rect::from_min_max(pos2(-1e30, -1e30), pos2(1e30, 1e30));
    mesh.add_rect_with_uv(rect, Rect::from_min_max(pos2(-1e38, 1e38), pos2(-1e38, -1e38)), RED);
    mesh.add_rect_with_uv(rect, Rect::from_min_max(pos2(-1e38, 1e38), pos2(1e38, -1e38)), RED);
    let texture = || ColorImage::new([2, 1], vec![Color32::WHITE; 2]);
    for wrap_mode in [TextureWrapMode::ClampToEdge, TextureWrapMode::Repeat, TextureWrapMode::MirroredRepeat]
    {
        for options in [TextureOptions::LINEAR, TextureOptions::NEAREST] {
            let image =
                paint(6, Color32::BLACK, texture(), TextureOptions { wrap_mode, ..options }, mesh.clone());
            assert!(image.pixels().all(|pixel| pixel.0 == [255, 0, 0, 255]), "{wrap_mode:?} {options:?}");
        }
    }
    let primitives = [ClippedPrimitive { clip_rect: rect, primitive: Primitive::Mesh(mesh) }];
    let mut painter = painter(white(), TextureOptions::LINEAR);
    for size in [[0, 0], [0, 3], [3, 0]] {
        assert_eq!(painter.paint(&primitives, 1.0, size, RED).dimensions(), (size[0], size[1]));
    }
    for pixels_per_point in [f32::NAN, f32::INFINITY, 0.0, -1.0] {
        let image = painter.paint(&primitives, pixels_per_point, [2, 2], Color32::BLACK);
        assert_eq!(digits(&image).concat(), "0000", "{pixels_per_point}");
    }
    let nowhere = Rect::from_min_max(pos2(f32::NAN, f32::NAN), pos2(f32::NAN, f32::NAN));
    let [ClippedPrimitive { primitive, .. }] = primitives;
    let unseen = [ClippedPrimitive { clip_rect: nowhere, primitive }];
    assert_eq!(digits(&painter.paint(&unseen, 1.0, [2, 2], Color32::BLACK)).concat(), "0000");
}

/// Numbers without a pattern, the same every time: from 0 to `below`.
fn numbers(mut seed: u64) -> impl FnMut(f32) -> f32 {
    move |below| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 40) as f32 / (1 << 24) as f32 * below
    }
}

/// Triangles and rectangles of all kinds: plain, shaded, textured, translucent, across the edges.
fn motley(size: f32) -> (ColorImage, Vec<ClippedPrimitive>) {
    let mut number = numbers(11);
    let texels = (0..35).map(|_| {
        let [r, g, b, a] = [(); 4].map(|()| number(256.0) as u8);
        Color32::from_rgba_unmultiplied(r, g, b, a)
    });
    let texture = ColorImage::new([7, 5], texels.collect());
    let primitives = (0..60).map(|index| {
        let mut mesh = Mesh::default();
        let place = |number: &mut dyn FnMut(f32) -> f32| pos2(number(size) - 4.0, number(size) - 4.0);
        for corner in 0..3 {
            let colour = Color32::from_rgba_unmultiplied(number(256.0) as u8, 90, number(256.0) as u8, 200);
            let pos = place(&mut number);
            let uv = if index % 3 == 0 { pos2(0.4, 0.4) } else { pos2(number(2.0) - 0.5, number(1.0)) };
            let color = if index % 2 == 0 || corner == 0 { colour } else { mesh.vertices[0].color };
            mesh.vertices.push(Vertex { pos, uv, color });
        }
        mesh.add_triangle(0, 1, 2);
        let (rect, uv) = (
            Rect::from_two_pos(place(&mut number), place(&mut number)).shrink(size / 8.0),
            Rect::from_min_max(pos2(0.0, number(0.5)), pos2(1.0 + number(1.0), 1.0)),
        );
        if rect.is_positive() {
            mesh.add_rect_with_uv(rect, uv, mesh.vertices[0].color);
        }
        let clip_rect = Rect::from_two_pos(place(&mut number), place(&mut number)).expand(size / 6.0);
        ClippedPrimitive { clip_rect, primitive: Primitive::Mesh(mesh) }
    });
    let primitives = primitives.collect();
    (texture, primitives)
}

fn motley_picture(size: u32, options: TextureOptions) -> RgbaImage {
    let (texture, primitives) = motley(size as f32);
    painter(texture, options).paint(&primitives, 1.0, [size; 2], Color32::from_gray(30))
}

/// FNV-1a, 64 bits.
fn hash(bytes: &[u8]) -> u64 {
    bytes
        .iter()
        .fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3))
}

/// The contract: these bits on every machine. Who changes them says so in the changelog.
#[test]
fn the_bits_of_a_picture_stay() {
    let repeating = TextureOptions::LINEAR_REPEAT;
    let hashes = [TextureOptions::LINEAR, TextureOptions::NEAREST, repeating]
        .map(|options| hash(&motley_picture(64, options)));
    assert_eq!(
        hashes.map(|hash| format!("{hash:016x}")),
        ["7e6757f6117b08f6", "c1c923cebae4e184", "cca865496262359a"]
    );
}

/// A rectangle that is large enough to be shared among threads is the same painted strip by strip, where no strip is.
#[test]
fn threads_change_no_bit() {
    const SIDE: f32 = 400.0;
    let (texture, _) = motley(SIDE);
    let mut mesh = Mesh::default();
    let rect = Rect::from_min_max(pos2(3.3, 1.2), pos2(SIDE - 5.0, SIDE - 1.7));
    mesh.add_rect_with_uv(rect, Rect::from_min_max(pos2(0.1, 0.0), pos2(1.9, 1.0)), Color32::WHITE);
    let clipped = |from: f32, to: f32| ClippedPrimitive {
        clip_rect: Rect::from_min_max(pos2(0.0, from), pos2(SIDE, to)),
        primitive: Primitive::Mesh(mesh.clone()),
    };
    let paint = |primitives: &[ClippedPrimitive]| {
        let mut painter = painter(texture.clone(), TextureOptions::LINEAR_REPEAT);
        painter.paint(primitives, 1.0, [SIDE as u32; 2], Color32::BLACK)
    };
    let strips: Vec<_> =
        (0..40).map(|strip| clipped(strip as f32 * 10.0, strip as f32 * 10.0 + 10.0)).collect();
    let expected = paint(&strips);
    for count in [1, 2, 5] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build().unwrap();
        assert!(pool.install(|| paint(&[clipped(0.0, SIDE)])) == expected, "{count} threads");
    }
}

fn small_app(ui: &mut Ui) {
    egui::CentralPanel::default().show(ui, |ui| {
        ui.heading("Bit for bit");
        ui.horizontal(|ui| {
            let _ = ui.button("Step");
            ui.checkbox(&mut true, "Pinned");
        });
        ui.add(egui::Slider::new(&mut 0.42, 0.0..=1.0));
        ui.add(egui::ProgressBar::new(0.3).text("31 of 70"));
    });
}

/// `tests/app.png` is the picture. `UPDATE_SNAPSHOTS=1` makes it again.
#[test]
fn an_app_looks_as_it_did() {
    let picture = Headless::new(180.0, 104.0, 1.5).frames(3, Vec::new(), small_app);
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/app.png");
    if std::env::var_os("UPDATE_SNAPSHOTS").is_some() {
        picture.save(path).unwrap();
    }
    let golden = image::open(path).unwrap().into_rgba8();
    assert_eq!(picture.dimensions(), golden.dimensions());
    let differing = picture.pixels().zip(golden.pixels()).filter(|(now, then)| now != then).count();
    if differing > 0 {
        let seen = concat!(env!("CARGO_TARGET_TMPDIR"), "/app.png");
        picture.save(seen).unwrap();
        panic!("{differing} pixels differ from {path}; see {seen}");
    }
}

#[cfg(feature = "kittest")]
#[test]
fn a_harness_paints_what_a_headless_window_paints() {
    // Not in the panel: the harness puts one of its own around the app.
    let still = |ui: &mut Ui| {
        let painter = ui.ctx().debug_painter();
        painter.circle_filled(pos2(20.0, 20.0), 12.3, RED);
        painter.text(
            pos2(40.0, 8.0),
            egui::Align2::LEFT_TOP,
            "Both",
            egui::FontId::default(),
            Color32::GREEN,
        );
    };
    let mut harness = egui_kittest::HarnessBuilder::default()
        .with_size(vec2(90.0, 40.0))
        .with_pixels_per_point(1.25)
        .renderer(Painter::default())
        .build_ui(still);
    harness.run();
    let picture = Headless::new(90.0, 40.0, 1.25).frames(3, Vec::new(), still);
    assert!(harness.render().unwrap() == picture);
}
