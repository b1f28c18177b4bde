//! NumPy arrays of doubles.

use std::path::Path;

use npyz::WriterBuilder;

use super::{Result, atomic};

/// Writes an array, row-major (the last index runs fastest).
pub fn write(path: &Path, shape: &[usize], values: &[f64]) -> Result<()> {
    atomic::write_with(path, |out| {
        let count = shape.iter().try_fold(1_usize, |product, &side| product.checked_mul(side));
        if count != Some(values.len()) {
            return Err(std::io::Error::other(format!("{} values do not fill {shape:?}", values.len())));
        }
        let shape: Vec<u64> = shape.iter().map(|&side| side as u64).collect();
        let mut writer = npyz::WriteOptions::new().default_dtype().shape(&shape).writer(out).begin_nd()?;
        writer.extend(values.iter().copied())?;
        writer.finish()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_array_reads_back_with_its_shape() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.npy");
        let values: Vec<f64> = (0..6).map(|i| f64::from(i) / 7.0).collect();
        write(&path, &[2, 3], &values).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        let file = npyz::NpyFile::new(&bytes[..]).unwrap();
        assert_eq!(file.shape(), [2, 3]);
        assert_eq!(file.order(), npyz::Order::C);
        assert_eq!(file.into_vec::<f64>().unwrap(), values);
        assert!(write(&path, &[2, 4], &values).is_err());
        assert_eq!(std::fs::read(&path).unwrap(), bytes);
    }
}
