//! NumPy in and out. Masks are borrowed: a frame is copied where it is looked at. What goes out owns its memory.

use backlit_tracking::camera::Rig;
use glam::{DMat3, DVec3};
use numpy::ndarray::{Axis, Dimension, IntoDimension};
use numpy::{
    Element, PyArray, PyArray3, PyArrayDescrMethods, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn,
    PyUntypedArray, PyUntypedArrayMethods, dtype,
};
use pyo3::prelude::*;
use pyo3::types::{PyList, PyTuple};

use crate::errors::wrong;

/// An array of this shape that owns these values.
pub(crate) fn owned<'py, T: Element + Copy, D: Dimension>(
    py: Python<'py>,
    shape: impl IntoDimension<Dim = D>,
    values: &[T],
) -> PyResult<Bound<'py, PyArray<T, D>>> {
    let array = PyArray::<T, D>::zeros(py, shape, false);
    array.try_readwrite()?.as_slice_mut()?.copy_from_slice(values);
    Ok(array)
}

/// The numbers of an array of any kind of number, row by row, and its shape.
pub(crate) fn numbers(argument: &str, value: &Bound<'_, PyAny>) -> PyResult<(Vec<f64>, Vec<usize>)> {
    let numpy = value.py().import("numpy")?;
    let array = numpy.call_method1("ascontiguousarray", (value, "float64"));
    let array = array.map_err(|_error| wrong(argument, "an array of numbers", &kind_text(value)))?;
    let array: PyReadonlyArrayDyn<'_, f64> = array.cast::<PyArrayDyn<f64>>()?.try_readonly()?;
    Ok((array.as_slice()?.to_vec(), array.shape().to_vec()))
}

/// The same of a shape that is known; `None` is any length.
pub(crate) fn numbers_of(
    argument: &str,
    value: &Bound<'_, PyAny>,
    expected: &[Option<usize>],
    words: &str,
) -> PyResult<Vec<f64>> {
    let (numbers, mut shape) = numbers(argument, value)?;
    // ascontiguousarray makes one dimension of none.
    if expected.is_empty() && shape == [1] {
        shape.clear();
    }
    let fits = shape.len() == expected.len()
        && shape.iter().zip(expected).all(|(found, expected)| expected.is_none_or(|side| side == *found));
    if fits { Ok(numbers) } else { Err(wrong(argument, words, &format!("the shape {}", shape_text(&shape)))) }
}

/// Three numbers each.
pub(crate) fn points(numbers: &[f64]) -> Vec<DVec3> {
    numbers.as_chunks::<3>().0.iter().copied().map(DVec3::from_array).collect()
}

/// Nine numbers, row by row.
pub(crate) fn rows(matrix: DMat3) -> [f64; 9] {
    matrix.transpose().to_cols_array()
}

/// "(4, 100, 480, 272)".
pub(crate) fn shape_text(shape: &[usize]) -> String {
    match shape {
        [one] => format!("({one},)"),
        _ => format!("({})", shape.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")),
    }
}

/// What an argument is, for a message: its type, or the shape and kind of an array.
fn kind_text(value: &Bound<'_, PyAny>) -> String {
    if let Ok(array) = value.cast::<PyUntypedArray>() {
        return format!("{} of the shape {}", array.dtype(), shape_text(array.shape()));
    }
    value.get_type().name().map_or_else(|_| "something else".to_owned(), |name| name.to_string())
}

/// Masks of every camera: whole recordings, or one moment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum MaskShape {
    /// `(cameras, frames, height, width)`.
    Recording,
    /// `(cameras, height, width)`.
    Moment,
}

impl MaskShape {
    const fn sides(self) -> usize {
        match self {
            Self::Recording => 4,
            Self::Moment => 3,
        }
    }

    const fn expected(self) -> &'static str {
        match self {
            Self::Recording => {
                "an array (cameras, frames, height, width) of bool or uint8, or a list of an array \
                 (frames, height, width) each camera"
            }
            Self::Moment => {
                "an array (cameras, height, width) of bool or uint8, or a list of an array (height, width) each camera"
            }
        }
    }
}

/// The masks of one camera, `(frames, height, width)`, still Python's.
#[derive(Debug)]
pub(crate) struct CameraMasks {
    array: Py<PyArray3<u8>>,
    /// Whether they are True and False: then 1 is written as white.
    pub(crate) is_boolean: bool,
    /// Frames, height, width.
    pub(crate) shape: [usize; 3],
}

impl CameraMasks {
    /// The numbers of a frame, row by row; `None` where Python has gone or writes to the array.
    pub(crate) fn frame(&self, frame: usize) -> Option<Vec<u8>> {
        let copied = Python::try_attach(|py| {
            let array = self.array.bind(py).try_readonly().ok()?;
            let view = array.as_array();
            let frame = (frame < view.len_of(Axis(0))).then(|| view.index_axis(Axis(0), frame))?;
            Some(match frame.as_slice() {
                Some(numbers) => numbers.to_vec(),
                None => frame.iter().copied().collect(),
            })
        });
        let mut numbers = copied.flatten()?;
        if self.is_boolean {
            numbers.iter_mut().for_each(|number| *number = if *number == 0 { 0 } else { u8::MAX });
        }
        Some(numbers)
    }

    fn of(argument: &str, value: &Bound<'_, PyAny>, shape: MaskShape) -> PyResult<Self> {
        let refuse = || wrong(argument, shape.expected(), &kind_text(value));
        let array = value.cast::<PyUntypedArray>().map_err(|_error| refuse())?;
        let py = value.py();
        let is_boolean = array.dtype().is_equiv_to(&dtype::<bool>(py));
        if !is_boolean && !array.dtype().is_equiv_to(&dtype::<u8>(py)) {
            return Err(refuse());
        }
        let mut frames = value.call_method1("view", ("uint8",))?;
        if shape == MaskShape::Moment {
            frames = frames.get_item(py.None())?;
        }
        let frames = frames.cast_into::<PyArray3<u8>>().map_err(|_error| refuse())?;
        let &[count, height, width] = frames.shape() else { return Err(refuse()) };
        Ok(Self { is_boolean, shape: [count, height, width], array: frames.unbind() })
    }
}

/// The masks of these cameras. Sizes and numbers of frames are checked, what is in them is not.
pub(crate) fn masks(rig: &Rig, value: &Bound<'_, PyAny>, shape: MaskShape) -> PyResult<Vec<CameraMasks>> {
    let is_list = value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>();
    let is_array = value.cast::<PyUntypedArray>().is_ok_and(|array| array.ndim() == shape.sides());
    if !is_list && !is_array {
        return Err(wrong("masks", shape.expected(), &kind_text(value)));
    }
    let count = value.len()?;
    if count != rig.count() {
        let expected = format!("masks of {} cameras, as there are in cams", rig.count());
        return Err(wrong("masks", &expected, &format!("{count}, {}", kind_text(value))));
    }
    let mut all: Vec<CameraMasks> = Vec::with_capacity(count);
    for (index, camera) in rig.cameras().iter().enumerate() {
        let argument = if is_list { format!("masks[{index}]") } else { "masks".to_owned() };
        let masks = CameraMasks::of(&argument, &value.get_item(index)?, shape)?;
        let [frames, height, width] = masks.shape;
        if [height, width] != [camera.height(), camera.width()] {
            let expected = format!(
                "height and width {} × {}, the size of camera \"{}\"",
                camera.height(),
                camera.width(),
                camera.name()
            );
            return Err(wrong(&format!("masks[{index}]"), &expected, &format!("{height} × {width}")));
        }
        let first = all.first().map_or(frames, |first| first.shape[0]);
        if frames == 0 || frames != first {
            let expected = if frames == 0 {
                "a frame or more".to_owned()
            } else {
                format!("{first} frames, as masks[0] has")
            };
            return Err(wrong(&format!("masks[{index}]"), &expected, &frames.to_string()));
        }
        all.push(masks);
    }
    Ok(all)
}
