//! Answers of a small picture as a table of comma-separated values, a row for each pixel.

use std::io::{self, Write};
use std::ops::Range;

use crate::tiles::{Samples, number_of};
use flipmap_engine::Trust;
use flipmap_pendulum::Status;
use flipmap_scene::{Document, PixelAxes};

/// Largest number of pixels of a table: more than a spreadsheet opens.
const MAX_PIXELS: u64 = 4_000_000;

/// Writes rows as samples come.
pub(super) struct CsvWriter<W: Write> {
    out: W,
    axes: PixelAxes,
    channels: Range<usize>,
    /// True if flips are timed, so that errors are estimated.
    has_error: bool,
    /// Index of the next pixel.
    next: u64,
}

impl<W: Write> CsvWriter<W> {
    /// Writes the names of the columns: the plane's two coordinates, the same from the centre, the
    /// channels of the question, status, trust, and the estimated error in s if flips are timed.
    /// Refuses a picture that is too large for a table.
    pub(super) fn new(
        mut out: W,
        size: [u32; 2],
        document: &Document,
        channels: Range<usize>,
    ) -> io::Result<Self> {
        let pixels = size.map(u64::from).iter().product::<u64>();
        if pixels > MAX_PIXELS {
            return Err(io::Error::other(format!(
                "a table has at most {MAX_PIXELS} rows, and the picture {pixels} pixels: name an .npz"
            )));
        }
        let axes = PixelAxes::new(&document.scene(), size);
        let known = &document.question.ask.kind().channels[channels.clone()];
        let [x, y] = axes.names_beside(&document.scene());
        let places = [x.clone(), y.clone(), format!("{x}_from_center"), format!("{y}_from_center")];
        let known = known.iter().map(|channel| channel.name);
        let has_error = document.question.ask.times_flips();
        let error = has_error.then_some("error");
        let rest = known.chain(["status", "trust"]).chain(error).map(str::to_string);
        let names: Vec<String> = places.into_iter().chain(rest).collect();
        writeln!(out, "{}", names.join(","))?;
        Ok(CsvWriter { out, axes, channels, has_error, next: 0 })
    }

    /// Writes the next samples.
    pub(super) fn write(&mut self, samples: &Samples) -> io::Result<()> {
        let width = u64::from(self.axes.size[0]);
        for index in 0..samples.len() {
            let [column, row] = [self.next % width, self.next / width].map(|place| place as u32);
            let status = samples.get(index).status;
            let [x, y] = self.axes.coordinates(column, row);
            let [from_x, from_y] = self.axes.offset(column, row);
            write!(self.out, "{x},{y},{from_x:?},{from_y:?}")?;
            for value in &samples.values(index)[self.channels.clone()] {
                write!(self.out, ",{}", number_of(status, *value))?;
            }
            write!(self.out, ",{},{}", word(status), trust_word(samples.trust(index)))?;
            if self.has_error {
                write!(self.out, ",{:.1e}", samples.error_secs(index))?;
            }
            writeln!(self.out)?;
            self.next += 1;
        }
        Ok(())
    }

    /// Returns the complete file.
    pub(super) fn into_inner(self) -> W {
        self.out
    }
}

fn word(status: Status) -> &'static str {
    match status {
        Status::Answered => "answered",
        Status::Unflipped => "unflipped",
        Status::Forbidden => "forbidden",
        Status::Failed => "failed",
    }
}

fn trust_word(trust: Trust) -> &'static str {
    Trust::ALL.iter().find(|(_, other)| *other == trust).map_or("", |(word, _)| *word)
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_engine::Assurance;
    use flipmap_pendulum::Outcome;

    #[test]
    fn a_row_says_where_what_and_how_sure() {
        let mut document = Document::default();
        document.view.width = "2".into();
        let mut samples = Samples::unflipped(2);
        samples.set(0, Outcome::flipped(1.5));
        samples.assure(0, Assurance::new(Trust::Agreed, 2e-9));
        let mut csv = CsvWriter::new(Vec::new(), [2, 1], &document, 0..1).unwrap();
        csv.write(&samples.part(0..1)).unwrap();
        csv.write(&samples.part(1..2)).unwrap();
        let text = String::from_utf8(csv.into_inner()).unwrap();
        let wanted = "theta1,theta2,theta1_from_center,theta2_from_center,time,status,trust,error\n\
                      -0.5,0,-0.5,0.0,1.5,answered,agreed,3.2e-9\n\
                      0.5,0,0.5,0.0,inf,unflipped,unchecked,NaN\n";
        assert_eq!(text, wanted);
        let large = CsvWriter::new(Vec::new(), [3000, 3000], &document, 0..1).err().unwrap();
        assert!(large.to_string().contains("at most 4000000 rows"), "{large}");
    }
}
