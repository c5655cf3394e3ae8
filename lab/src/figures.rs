//! Many measurements as few figures, and figures as CSV.

use std::io;

/// The mean, and its standard error if there are two values or more.
pub fn mean_and_error(values: &[f64]) -> (f64, Option<f64>) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let spread: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    let error = (spread / (count - 1.0) / count).sqrt();
    (mean, (values.len() > 1).then_some(error))
}

/// A heading and rows as CSV: fields that hold commas or quotes are quoted, rows end in a line feed.
///
/// # Errors
/// `out` fails.
pub fn write_csv<const COLUMNS: usize>(
    out: impl io::Write,
    heading: [&str; COLUMNS],
    rows: impl IntoIterator<Item = [String; COLUMNS]>,
) -> io::Result<()> {
    let mut writer = csv::Writer::from_writer(out);
    writer.write_record(heading)?;
    for row in rows {
        writer.write_record(row)?;
    }
    writer.flush()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_standard_error_needs_two_values() {
        assert_eq!(mean_and_error(&[3.0]), (3.0, None));
        // Deviations of ±1 from 2: a variance of 2, over two values.
        assert_eq!(mean_and_error(&[1.0, 3.0]), (2.0, Some(1.0)));
    }

    #[test]
    fn commas_and_quotes_come_back() {
        let row = ["slices, then sweeps", "Owen-Sobol'", "a \"b\"", "0.5"].map(String::from);
        let mut text = Vec::new();
        write_csv(&mut text, ["a", "b", "c", "d"], [row.clone()]).unwrap();
        assert!(text.starts_with(b"a,b,c,d\n\"slices, then sweeps\",Owen-Sobol',"));
        let mut read = csv::Reader::from_reader(text.as_slice());
        let rows: Vec<[String; 4]> = read.deserialize().map(Result::unwrap).collect();
        assert_eq!(rows, [row]);
    }
}
