//! Pictures in rows and columns, with their headings: D and Λ as the report lays them out.

use image::{GrayImage, Rgba, RgbaImage};
use vello_cpu::kurbo::Point;

use crate::AsPicture;
use crate::colours::{PageColours, Theme};
use crate::page::{BODY, CENTRE_BOTTOM, LEFT_MIDDLE, LEFT_TOP, Page, TITLE as TITLE_SIZE};

/// A picture is enlarged, pixel by pixel, to at least this width, points.
const LEAST_WIDTH: u32 = 144;
/// Room between pictures, around all of them, and for the headings.
const GAP: u32 = 8;
const MARGIN: u32 = 14;
const ROW_NAME: u32 = 84;
const TITLE: u32 = 46;
const COLUMN_NAME: u32 = 22;
/// The narrowest sheet: its title must fit.
const LEAST_SHEET: u32 = 640;

/// Pictures in rows and columns.
#[derive(Debug, Clone, PartialEq)]
pub struct Sheet {
    /// What is shown.
    pub title: String,
    /// The conditions, in one line.
    pub subtitle: String,
    /// Headings of the columns.
    pub columns: Vec<String>,
    /// Heading and pictures of each row, all of one size.
    pub rows: Vec<(String, Vec<GrayImage>)>,
}

impl AsPicture for Sheet {
    fn picture(&self, theme: Theme) -> RgbaImage {
        let [wide, high] = self.cell();
        let across = MARGIN + ROW_NAME + self.columns.len() as u32 * (wide + GAP) + MARGIN - GAP;
        let down = MARGIN + TITLE + COLUMN_NAME + self.rows.len() as u32 * (high + GAP) + MARGIN - GAP;
        let colours = theme.page();
        let mut page = Page::new([across.max(LEAST_SHEET), down], colours.panel);
        self.headings(&mut page, colours);
        let mut sheet = page.finish();
        for (row, (_, pictures)) in self.rows.iter().enumerate() {
            for (column, picture) in pictures.iter().enumerate() {
                paste(&mut sheet, picture, self.enlarged(), self.corner(column, row));
            }
        }
        sheet
    }
}

impl Sheet {
    fn enlarged(&self) -> u32 {
        let width = self.pictures().map(GrayImage::width).max().unwrap_or(1).max(1);
        LEAST_WIDTH.div_ceil(width)
    }

    fn cell(&self) -> [u32; 2] {
        let largest = |side: fn(&GrayImage) -> u32| self.pictures().map(side).max().unwrap_or(0);
        [largest(GrayImage::width), largest(GrayImage::height)].map(|side| side * self.enlarged())
    }

    fn pictures(&self) -> impl Iterator<Item = &GrayImage> {
        self.rows.iter().flat_map(|(_, pictures)| pictures)
    }

    /// Where a picture begins.
    fn corner(&self, column: usize, row: usize) -> [u32; 2] {
        let [wide, high] = self.cell();
        let x = MARGIN + ROW_NAME + column as u32 * (wide + GAP);
        [x, MARGIN + TITLE + COLUMN_NAME + row as u32 * (high + GAP)]
    }

    fn headings(&self, page: &mut Page, colours: &PageColours) {
        let [wide, high] = self.cell().map(f64::from);
        let at = |x: u32, y: u32| Point::new(x.into(), y.into());
        page.text(at(MARGIN, MARGIN), LEFT_TOP, &self.title, TITLE_SIZE, colours.text);
        page.text(at(MARGIN, MARGIN + 24), LEFT_TOP, &self.subtitle, BODY, colours.text2);
        for (column, name) in self.columns.iter().enumerate() {
            let [x, y] = self.corner(column, 0);
            let above = at(x, y) + (0.5 * wide, -5.0);
            page.text(above, CENTRE_BOTTOM, name, BODY, colours.text);
        }
        for (row, (name, _)) in self.rows.iter().enumerate() {
            let [_, y] = self.corner(0, row);
            page.text(at(MARGIN, y) + (0.0, 0.5 * high), LEFT_MIDDLE, name, BODY, colours.text);
        }
    }
}

/// Puts a picture down with every pixel repeated `times` across and down.
fn paste(sheet: &mut RgbaImage, picture: &GrayImage, times: u32, [x, y]: [u32; 2]) {
    for (column, row, level) in picture.enumerate_pixels() {
        let colour = Rgba([level[0], level[0], level[0], u8::MAX]);
        for (dx, dy) in (0..times * times).map(|part| (part % times, part / times)) {
            sheet.put_pixel(x + column * times + dx, y + row * times + dy, colour);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_stand_in_rows_and_columns_and_the_same_sheet_is_the_same_picture() {
        let picture = |level| GrayImage::from_pixel(36, 48, image::Luma([level]));
        let sheet = Sheet {
            title: "D and Λ".to_owned(),
            subtitle: "36 × 48 pixels".to_owned(),
            columns: ["frame 1", "frame 9"].map(str::to_owned).into(),
            rows: vec![
                ("cam01 D".to_owned(), vec![picture(10), picture(20)]),
                ("cam01 Λ".to_owned(), vec![picture(30), picture(40)]),
            ],
        };
        for theme in [Theme::Light, Theme::Dark] {
            let drawn = sheet.picture(theme);
            assert_eq!(drawn, sheet.picture(theme));
            for (index, level) in [10, 20, 30, 40].into_iter().enumerate() {
                let [x, y] = sheet.corner(index % 2, index / 2);
                assert_eq!(sheet.cell(), [144, 192]);
                for [x, y] in [[x, y], [x + 143, y + 191]] {
                    assert_eq!(drawn.get_pixel(x, y).0, [level, level, level, 255]);
                }
                assert_ne!(drawn.get_pixel(x + 144, y).0[0], level);
            }
        }
    }
}
